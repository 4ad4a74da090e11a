// SPDX-License-Identifier: MIT
// The noise that points along a curve show themselves. Used by FindCorners only.
#pragma once

#include <Eigen/Core>

namespace batten::internal {

// Standard deviation of a coordinate across the curve, from differences of fourth to sixth order at
// up to 2000 places; 0 where they do not agree on one, as those of a curve or a polygon do not, and
// for fewer than 200 points. Noise that is white makes all of them alike.
double NoiseShown(const Eigen::Matrix3Xd& points);

}  // namespace batten::internal
