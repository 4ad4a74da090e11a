// SPDX-License-Identifier: MIT
// Points that need no judgement of their own.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/neighbours.h"
#include "batten/fitting/point_mask.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// Points near each other are taken 64 at a time. Those are inliers that agree with a quadric
// through most of their 64, as if they were not in it, and have neighbours there as near as points
// of a surface have them. `deviation` is the usual one of points from the planes of their
// neighbours, `reach` the usual distance of the sixth neighbour; small ones count for less than
// a share of the place's own reach. Wherever the 64 do not agree none is inliers. The same
// on any number of threads. O(m).
PointMask PrescreenInliers(const Eigen::Matrix3Xd& points,
                           const NeighbourIndex& index,
                           double deviation,
                           double reach,
                           ThreadPool& pool);

}  // namespace batten::internal
