// SPDX-License-Identifier: MIT
// Prescreen of a cloud: inliers along curves, before the curves are known.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// The indices of the points that seem to lie along curves, ascending; all where fewer than one in
// 100 does not, or where there are fewer than 100 points. A point with more room around it than
// most must be in a row with its 8 or 30 nearest (among at most 2000 points): these have to be
// longer than thick, and it has to be as near their parabola as they are. Without noise every point
// has to pass this test among those left. Points must be distinct and in an order unrelated to the
// curve. O(m).
std::vector<int> CurveInliers(const Eigen::Matrix3Xd& points, ThreadPool& pool);

}  // namespace batten::internal
