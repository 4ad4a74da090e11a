// SPDX-License-Identifier: MIT
// Which points of a cloud are connected.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/neighbours.h"
#include "batten/fitting/point_cloud.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// The least index of a point that each point is connected with, as FindCloudParts says it. The
// index holds the points. O(m log m), with neighbours of those alone that cells do not join to the
// largest part.
std::vector<Eigen::Index> ConnectedPoints(const Eigen::Matrix3Xd& points,
                                          const NeighbourIndex& index,
                                          ThreadPool& pool);

// Marks points of small parts beside one that holds most of the cloud: clutter, supports, strays.
// None where no part holds four fifths of the points. O(m log m).
PointMask SmallParts(const Eigen::Matrix3Xd& points, const NeighbourIndex& index, ThreadPool& pool);

}  // namespace batten::internal
