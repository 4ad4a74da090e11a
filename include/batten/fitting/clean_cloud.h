// SPDX-License-Identifier: MIT
// Removal of stray points before anything else is asked of a cloud.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/point_cloud.h"

namespace batten {

// Points whose mean distance to so many nearest neighbours exceeds the mean of all those distances
// by so many of their standard deviations are stray.
struct StatisticalRemoval {
  int neighbours = 16;    // ≥ 1
  double deviations = 3;  // > 0
};

// Returns the indices of the points that stay, ascending. One threshold serves the whole cloud:
// where density varies, sparse places go as well; a fit's own search for outliers has local ones.
// Throws std::invalid_argument where an option breaks its rule. By PCL's StatisticalOutlierRemoval
// in float about the middle of the cloud. [Rusu 2009, §4.1.2] O(m k log m), on one thread.
std::vector<Eigen::Index> WithoutStatisticalOutliers(const PointCloud& cloud,
                                                     const StatisticalRemoval& options = {});

}  // namespace batten
