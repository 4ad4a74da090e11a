// SPDX-License-Identifier: MIT
// The angular range that points cover on a circle, and the outermost points of a set in the plane,
// in linear time.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/frame.h"

namespace batten::internal {

// Whether so many angles lie all round the circle: no gap between neighbours is above 60°, or the
// widest is no more than 1.5 times the mean of the others: few points evenly spread.
bool AllRound(double widest_gap, Eigen::Index count);

// The range that one angle or more cover: the full circle, from 0, where they lie all round it,
// else everything but the widest gap.
AngleRange AnglesCovered(const Eigen::VectorXd& angles);

// The corners of the convex hull and few other points: points strictly inside the polygon of the
// outermost points in some directions are dropped. [Akl & Toussaint 1978]
std::vector<Eigen::Vector2d> OutermostOf(const Eigen::Matrix2Xd& points);

}  // namespace batten::internal
