// SPDX-License-Identifier: MIT
// Statistics of a cloud before any fit: point spacing, noise and outliers.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "batten/fitting/neighbours.h"
#include "batten/fitting/point_mask.h"
#include "batten/fitting/progress.h"
#include "batten/geometry/thread_pool.h"

namespace batten {

struct CloudStatistics {
  // Mean distance between neighbours on the surface, estimated from the radius that holds 16
  // points: as a count of points per area it is not biased by near-duplicates.
  double spacing = 0;
  // Standard deviation of the points along the surface normal, estimated from quadrics fitted to
  // neighbours: to more of them where the noise is no longer small against the spacing, or where
  // the nearest lie on one line.
  double noise = 0;
  // True for outliers: points off the surface of the points around them; see cloud_outliers.h.
  PointMask outliers;
  Eigen::Index outlier_count = 0;
};

struct CloudStatisticsOptions {
  int samples = 3000;      // points from which spacing and noise are estimated
  std::uint64_t seed = 1;  // of the random choice of these points
  bool find_outliers = true;
};

// Estimates spacing and noise and finds the outliers. Points are distinct and those of the index.
// Below 20 points no outliers are sought and the noise is 0.
CloudStatistics MeasureCloud(const Eigen::Matrix3Xd& points,
                             const NeighbourIndex& index,
                             const CloudStatisticsOptions& options,
                             ThreadPool& pool,
                             const Progress& progress = {});

}  // namespace batten
