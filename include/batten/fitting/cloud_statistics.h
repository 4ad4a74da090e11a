// SPDX-License-Identifier: MIT
// What a cloud says of itself before anything is fitted: spacing, noise, outliers.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "batten/fitting/neighbours.h"
#include "batten/fitting/point_mask.h"
#include "batten/fitting/progress.h"
#include "batten/geometry/thread_pool.h"

namespace batten {

struct CloudStatistics {
  // Mean distance of neighbours on the surface, from the radius that holds 16 points: a count of
  // points per area, which near-duplicates do not mislead.
  double spacing = 0;
  // Standard deviation of the points along the surface normal, from quadrics through neighbours:
  // more of them where the noise is no longer small against the spacing, or the nearest are on one
  // line.
  double noise = 0;
  // Set where a point stands off the surface of the points around it; see cloud_outliers.h.
  PointMask outliers;
  Eigen::Index outlier_count = 0;
};

struct CloudStatisticsOptions {
  int samples = 3000;      // points that spacing and noise are taken from
  std::uint64_t seed = 1;  // chooses them
  bool find_outliers = true;
};

// Points are distinct and those of the index. Below 20 points no outliers are sought and the noise
// is 0.
CloudStatistics MeasureCloud(const Eigen::Matrix3Xd& points,
                             const NeighbourIndex& index,
                             const CloudStatisticsOptions& options,
                             ThreadPool& pool,
                             const Progress& progress = {});

}  // namespace batten
