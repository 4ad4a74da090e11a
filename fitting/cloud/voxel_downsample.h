// SPDX-License-Identifier: MIT
// A cloud thinned to one point in each cell of a cubic grid.
#pragma once

#include <vector>

#include "batten/fitting/point_cloud.h"

namespace batten::internal {

// Points of the cloud with everything that belongs to them, in their order.
struct DownsampledCloud {
  PointCloud cloud;
  std::vector<Eigen::Index> kept;    // of every thinned point, the one given that it is
  std::vector<Eigen::Index> stands;  // for every point given, the thinned one of its cell
};

// Of the points in each cube of side `cell`, laid from the lower corner of the cloud's box, the one
// nearest to their mean, of equally near ones the first. Dense places then weigh no more than
// sparse ones: weights are those of the points that stay. Throws std::invalid_argument unless
// cell > 0, in the data's units. O(m log m).
DownsampledCloud Thinned(const PointCloud& cloud, double cell);

// The same with more points kept, given by their numbers in the cloud; they stand for themselves.
DownsampledCloud WithPoints(const PointCloud& cloud,
                            DownsampledCloud thinned,
                            const std::vector<Eigen::Index>& more);

}  // namespace batten::internal
