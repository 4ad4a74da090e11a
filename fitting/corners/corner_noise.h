// SPDX-License-Identifier: MIT
// Noise estimate from finite differences of points along a curve. Used by FindCorners only.
#pragma once

#include <Eigen/Core>

namespace batten::internal {

// Estimates the standard deviation of a coordinate across the curve, from differences of fourth to
// sixth order at up to 2000 places; 0 where they do not agree on one, as those of a curve or a
// polygon do not, and for fewer than 200 points. Noise that is white makes all of them alike.
double NoiseShown(const Eigen::Matrix3Xd& points);

}  // namespace batten::internal
