// SPDX-License-Identifier: MIT
// Approximation of a rational curve by polynomial cubics.
#pragma once

#include "batten/geometry/nurbs_curve.h"

namespace batten::internal {

// A polynomial cubic spline within `tolerance` (> 0, in the data's units) of a curve at the same
// parameters: the cubic Hermite interpolant on equal parts of every span, as smooth at the knots as
// the curve is there up to C1. Halving the parts divides the error by 16. Throws
// std::invalid_argument where the tolerance would need more than 4096 parts a span.
NurbsCurve<3> PolynomialCurve(const NurbsCurve<3>& curve, double tolerance);

}  // namespace batten::internal
