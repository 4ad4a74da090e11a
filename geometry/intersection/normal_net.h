// SPDX-License-Identifier: MIT
// The normals of a Bézier patch in Bernstein form. Internal to geometry.
#pragma once

#include <Eigen/Core>

namespace batten::internal {

// The coefficients of S_u × S_v · w³ / (p·q) of the patch whose columns (w·P, w) are given, v
// fastest, in degrees (3p − 1, 3q − 1), or of S_u × S_v in (2p − 1, 2q − 1) where all weights are
// the same. What is `rounding` of the greatest or less is zero, as at a collapsed edge: the others
// hold its normals. O(p²q²). [Sederberg & Meyers 1988, with the weights]
Eigen::Matrix3Xd NormalNet(const Eigen::Matrix4Xd& net, int p, int q, double rounding);

}  // namespace batten::internal
