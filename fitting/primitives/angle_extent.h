// SPDX-License-Identifier: MIT
// The angular range that points cover on a circle, and the outermost points of a set in the plane,
// in linear time. Used by the patches of fitted surfaces only.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/frame.h"

namespace batten::internal {

// The range that one angle or more cover. It is the full circle, from 0, where no gap between
// neighbours is above 60°, or where the largest gap is no more than 1.5 times the mean of the
// others; else everything but the largest gap.
AngleRange AnglesCovered(const Eigen::VectorXd& angles);

// The corners of the convex hull and few other points: points strictly inside the polygon of the
// outermost points in some directions are dropped. [Akl & Toussaint 1978]
std::vector<Eigen::Vector2d> OutermostOf(const Eigen::Matrix2Xd& points);

}  // namespace batten::internal
