// SPDX-License-Identifier: MIT
// Every point with its distance from the geometry, as a file.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "batten/fitting/point_cloud.h"
#include "batten/fitting/point_mask.h"
#include "batten/io/atomic_file.h"

namespace batten {

struct PointResiduals {
  const PointCloud& cloud;
  const Eigen::VectorXd& distances;   // signed where the geometry has sides
  const Eigen::MatrixXd& parameters;  // of the feet, 1 or 2 × m
  const PointMask& outliers;          // whether a point was set aside
  double colour_range = 1;  // > 0; distances at which colours are full, see DeviationColour
  std::vector<int> owners =
      {};  // of several geometries, the number of the nearest; empty: one only
  Eigen::VectorXd deviations = {};  // of the geometry's place at each foot; empty: not known
};

// By the extension, any case:
//   .ply  binary little-endian: doubles x y z, distance, u, v (surfaces), colours by the distance
//         (uchar red green blue), uchar outlier (0 or 1), int index (of several geometries),
//         double sigma (where deviations are known)
//   .csv  a header line x,y,z,distance,u[,v],outlier[,index][,sigma] and shortest numbers that read
//   back
//         exactly
// in world coordinates. The file appears on Commit(). Throws UsageError for another extension,
// WriteError where it can't be written, std::invalid_argument where sizes disagree.
std::unique_ptr<AtomicFile> WriteResiduals(const std::string& path,
                                           const PointResiduals& residuals);

// Throws UsageError for what WriteResiduals refuses by its name.
void CheckResidualsName(const std::string& path);

}  // namespace batten
