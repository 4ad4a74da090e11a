// SPDX-License-Identifier: MIT
// A quick prescreen for inliers, which then need no outlier test of their own.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/neighbours.h"
#include "batten/fitting/point_mask.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// Tests the points in patches of 64 neighbouring ones. A point is an inlier if its leave-one-out
// residual from a robust quadric through its patch is small and its neighbours in the patch are as
// near as those on a surface. `deviation` is the typical deviation of points from the planes of
// their neighbours (not less than a share of the patch's own reach is used), `reach` the typical
// distance of the sixth neighbour. In a patch whose points mostly do not agree with one quadric,
// no point is an inlier. The same on any number of threads. O(m).
PointMask PrescreenInliers(const Eigen::Matrix3Xd& points,
                           const NeighbourIndex& index,
                           double deviation,
                           double reach,
                           ThreadPool& pool);

}  // namespace batten::internal
