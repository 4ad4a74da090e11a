// SPDX-License-Identifier: MIT
// Outlier detection in a cloud: points that lie off the surface of their neighbours.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/point_mask.h"
#include "batten/fitting/neighbours.h"
#include "batten/fitting/progress.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// Finds the outliers among points (3 × m, m ≥ 20, distinct, those of the index) of given spacing
// and noise. Points that agree with the plane of their neighbours are inliers. Every other point is
// compared with the inliers nearest to it: it is an outlier if it lies off quadrics through points
// near them by several standard deviations, or far from all of them, unless most of its own
// nearest neighbours are off too and form a thin layer (a rib, a step, rough ground). All
// thresholds are local, so that density may vary. O(m log m).
PointMask FindOutliers(const Eigen::Matrix3Xd& points,
                       const NeighbourIndex& index,
                       double spacing,
                       double noise,
                       ThreadPool& pool,
                       const Progress& progress = {});

}  // namespace batten::internal
