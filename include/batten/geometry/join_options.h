// SPDX-License-Identifier: MIT
// The tolerances by which two shapes that meet are judged.
#pragma once

#include <optional>

namespace batten {

struct JoinOptions {
  // The widest gap of what meets, in the data's units, > 0; none: 1e-9 of the diagonal of the
  // larger shape's box of control points. Never less than eight units in the last place of the
  // largest coordinate.
  std::optional<double> position_tolerance = std::nullopt;
  double angle_tolerance = 1e-6;  // radians, > 0
  // Of the larger of the two curvatures, or of one over the diagonal where both are less; > 0.
  double curvature_tolerance = 1e-5;
  // Of the longer of the two derivatives, > 0; second derivatives count as no shorter than the
  // square of the first over the diagonal.
  double derivative_tolerance = 1e-6;
};

}  // namespace batten
