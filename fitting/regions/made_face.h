// SPDX-License-Identifier: MIT
// The faces of a part with the points they are fitted to, before they are put in order.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "batten/fitting/part_options.h"
#include "batten/fitting/point_cloud.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/regions/region_face.h"
#include "fitting/regions/region_points.h"

namespace batten::internal {

struct MadeFace {
  PartFace face;
  FaceSummary summary;      // its kind and numbers
  std::vector<int> points;  // of the merged cloud
  Eigen::VectorXd residuals;
  Eigen::Matrix2Xd parameters;
  int shape = -1;  // the number of its fit; of free ones none
};

// The faces that shapes make. `move` is what coordinates of the cloud gain in the result.
std::vector<MadeFace> ShapeFaces(const RegionPoints& data,
                                 const std::vector<RegionFace>& shapes,
                                 const Eigen::Vector3d& move,
                                 std::vector<std::string>& warnings,
                                 ThreadPool& pool);

// Free surfaces through sets of the cloud's points; none of those where FitSurface refuses.
std::vector<MadeFace> FreeFaces(const PointCloud& cloud,
                                std::vector<std::vector<int>> pieces,
                                const PartFitOptions& options,
                                std::vector<std::string>& warnings);

}  // namespace batten::internal
