// SPDX-License-Identifier: MIT
// Bézier surfaces made by moving one curve along another without turning it.
#pragma once

#include <optional>

#include "batten/geometry/bezier_surface.h"

namespace batten::internal {

// S(u,v) = A(u) + B(v) − B(0): the control net P_ij = A_i + B_j − B_0, weights a_i·b_j. All its
// quadrilaterals are parallelograms; without weights, all twists vanish. [Farin 2002, §15.5]
BezierSurface TranslationalSurface(const BezierCurve<3>& along_u, const BezierCurve<3>& along_v);

struct TranslationalForm {
  BezierCurve<3> along_u, along_v;  // the edges v = 0 and u = 0
  double error;                     // the surface they make is nowhere farther away: DeviationBound
};

// The curves that the surface is the translational surface of; none where those it would have to
// be, two of its edges, make another one, farther away than the tolerance (data's units). Throws
// std::invalid_argument when the tolerance is negative.
std::optional<TranslationalForm> AsTranslational(const BezierSurface& surface, double tolerance);

}  // namespace batten::internal
