// SPDX-License-Identifier: MIT
// The four sides of outlines with exactly four corners.
#pragma once

#include <array>
#include <optional>

#include "batten/fitting/outline.h"

namespace batten::internal {

struct OutlineSide {
  NurbsCurve<2> curve;  // open, clamped, cubic, counter-clockwise along the outline
};

// The sides of an outer loop (counter-clockwise, of degree one or three, corners ascending) that
// has exactly four corners, each of which turns to the left by 50° to 130°, and no notch: nowhere
// does a side run more than 60° off the way from its start to its end. The first side is the one
// that runs most along +u; the end of each is exactly the start of the next. O(control points).
std::optional<std::array<OutlineSide, 4>> FourSides(const OutlineCurve& outer);

}  // namespace batten::internal
