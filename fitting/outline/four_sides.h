// SPDX-License-Identifier: MIT
// The four sides of outlines with exactly four corners.
#pragma once

#include <optional>
#include <vector>

#include "batten/fitting/outline.h"

namespace batten::internal {

// The sides of an outer loop (counter-clockwise, of degree one or three, corners ascending) that
// has exactly four corners, each of which turns to the left by 50° to 130°, and no notch: nowhere
// does a side run more than 60° off the way from its start to its end. The first side is the one
// that runs most along +u; the end of each is exactly the start of the next. They are open, clamped
// and cubic. O(control points).
std::optional<std::vector<NurbsCurve<2>>> FourSides(const OutlineCurve& outer);

}  // namespace batten::internal
