// SPDX-License-Identifier: MIT
// Points that stand off the surface their neighbours lie in.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/point_mask.h"
#include "batten/fitting/neighbours.h"
#include "batten/fitting/progress.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// Points (3 × m, m ≥ 20, distinct, those of the index) with their noise and spacing. Trusted are
// points that agree with the plane of their neighbours. Every other point is measured against the
// trusted ones nearest to it: it is an outlier where it stands off the quadric through them by
// several of their own deviations, or away from all of them, unless it lies near others there with
// others like itself (a rib, a step, rough ground). All thresholds are local, so that density may
// vary. O(m log m).
PointMask FindOutliers(const Eigen::Matrix3Xd& points,
                       const NeighbourIndex& index,
                       double spacing,
                       double noise,
                       ThreadPool& pool,
                       const Progress& progress = {});

}  // namespace batten::internal
