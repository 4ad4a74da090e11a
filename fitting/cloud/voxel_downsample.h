// SPDX-License-Identifier: MIT
// Voxel downsampling: a cloud thinned to one point in each cell of a cubic grid.
#pragma once

#include <vector>

#include "batten/fitting/point_cloud.h"

namespace batten::internal {

// The points kept, in their order in the cloud, with their attributes.
struct DownsampledCloud {
  PointCloud cloud;
  std::vector<Eigen::Index> kept;    // for every point kept, its index in the cloud given
  std::vector<Eigen::Index> stands;  // for every point given, the point kept in its cell
};

// Keeps one point in each cube of side `cell` (a grid from the lower corner of the cloud's box):
// the point nearest to the mean of the cube's points, of equally near ones the first. Dense places
// then weigh no more than sparse ones: each point kept has its own weight. Throws
// std::invalid_argument unless cell > 0, in the data's units. O(m log m).
DownsampledCloud Thinned(const PointCloud& cloud, double cell);

// Adds more points, given by their indices in the cloud, to those kept; each represents itself.
DownsampledCloud WithPoints(const PointCloud& cloud,
                            DownsampledCloud thinned,
                            const std::vector<Eigen::Index>& more);

}  // namespace batten::internal
