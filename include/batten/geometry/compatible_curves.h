// SPDX-License-Identifier: MIT
// Curves brought over one basis.
#pragma once

#include <vector>

#include "batten/geometry/nurbs_curve.h"

namespace batten {

// The same curves over one basis on [0, 1]: degrees are raised to the highest, knots merged (those
// within 1e-12 of one another become one). Periodic only where all are, over the same knots; else
// clamped. Rounding is that of degree elevation and knot insertion. Throws std::invalid_argument
// where there are no curves. O(curves · knots of all). [Piegl & Tiller 1997, §10.3]
std::vector<NurbsCurve<3>> Compatible(std::vector<NurbsCurve<3>> curves);

}  // namespace batten
