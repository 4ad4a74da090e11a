// SPDX-License-Identifier: MIT
// Which points of a cloud are connected.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/neighbours.h"
#include "batten/fitting/point_cloud.h"
#include "batten/fitting/point_mask.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// Points connected with fewer, of all by number or share, are strays and no part.
inline constexpr Eigen::Index kLeastPartPoints = 30;
inline constexpr double kLeastPartShare = 1e-3;

// The least index of a point that each point is connected with, as FindCloudParts says it. The
// index holds the points. O(m log m), with neighbours of those alone that cells do not join to the
// largest part.
std::vector<Eigen::Index> ConnectedPoints(const Eigen::Matrix3Xd& points,
                                          const NeighbourIndex& index,
                                          ThreadPool& pool);

// Small parts, of kLeastPartPoints at least, beside one that holds most of the points under a mask:
// clutter, supports. For every point the number of its small part, from 0, or −1: it is in none.
// Empty where there are none, as where no part holds four fifths of those in parts. O(m log m).
std::vector<int> SmallParts(const Eigen::Matrix3Xd& points,
                            const PointMask& mask,
                            ThreadPool& pool);

}  // namespace batten::internal
