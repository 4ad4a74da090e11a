// SPDX-License-Identifier: MIT
// Where a profile goes through the axis that it is to be turned about.
#pragma once

#include <vector>

#include "batten/geometry/frame.h"
#include "batten/geometry/nurbs_curve.h"

namespace batten::internal {

// The parameters, to 1e-12 of a piece, at which the profile passes from one side of the axis to the
// other, the seam of a closed one among them; touching it is not passing. None where the profile
// does not lie in a plane with the axis, to 1e-9 of its size. By signs of Bézier coefficients,
// halved. [Lane & Riesenfeld 1981]
std::vector<double> AxisCrossings(const NurbsCurve<3>& profile, const Frame& axis);

// Throws std::invalid_argument, `function` first, where there are two or more: turned by more than
// half a turn, what lies on both sides of the axis is swept over by both.
void RefuseCrossings(const NurbsCurve<3>& profile, const Frame& axis, const char* function);

}  // namespace batten::internal
