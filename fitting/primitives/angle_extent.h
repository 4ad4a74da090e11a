// SPDX-License-Identifier: MIT
// What points cover of a circle and of the plane, in linear time. Used by the patches of fitted
// surfaces only.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/frame.h"

namespace batten::internal {

// Of angles, at least one. All round, from 0, where no gap between neighbours is above 60°, or
// where the largest is no more than 1.5 times the mean of the others; else everything but the
// largest gap.
AngleRange AnglesCovered(const Eigen::VectorXd& angles);

// All corners of the convex hull and not many others: what is strictly inside a polygon of points
// that are outermost in some directions is left out. [Akl & Toussaint 1978]
std::vector<Eigen::Vector2d> OutermostOf(const Eigen::Matrix2Xd& points);

}  // namespace batten::internal
