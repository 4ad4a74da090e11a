// SPDX-License-Identifier: MIT
// Open or closed: the gap between the ends of points in order along a curve.
#pragma once

#include <Eigen/Core>
#include <numbers>

namespace batten::internal {

inline constexpr double kFacingAngle = std::numbers::pi / 6;  // ends within it face each other …
inline constexpr double kGapInLength = 0.1;  // … across a gap of at most so much of the length

struct EndGap {
  bool closed = false;
  bool repeated = false;  // the last point is the first again, to rounding
  double gap = 0;         // distance of the last point from the first
};

// Decides whether points in order along a curve (3 × m, plane curves at z = 0) that scatter about
// it by the standard deviation `noise` (≥ 0) in each coordinate are closed. They are when
//  (1) the ends coincide: within 1e-9 of the size, or within what noise explains, or
//  (2) they face each other across the gap, turning by 30° at most at either end, and the gap is no
//      longer than 3 steps of those nearby and than 0.1 of the length, or
//  (3) the gap is a step like its neighbours, which are even: the curve has a corner there, or few
//      points. Ends that lie side by side are open; so is a gap far shorter than the steps.
// Ends and their directions come from quadratics (least absolute distances) through as many points
// as the noise asks for. Fewer than 4 points that do not repeat the first are open. Throws
// std::invalid_argument when there is no point, or the noise is negative or not finite. O(m).
EndGap JudgeEnds(const Eigen::Matrix3Xd& points, double noise);

}  // namespace batten::internal
