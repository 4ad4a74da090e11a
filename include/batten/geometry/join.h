// SPDX-License-Identifier: MIT
// Two shapes that meet, as one.
#pragma once

#include "batten/geometry/direction.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// The first curve followed by the second, whose start must be the first one's end within
// `tolerance` (≥ 0, in the data's units; the common point is the middle of both). The first keeps
// its parameters, the second's are shifted to begin where the first end; the joint is a knot of
// multiplicity p there, of which RemoveKnot takes away what the continuity allows. Both are taken
// clamped, the lower degree is raised, and the second's weights are scaled to meet the first's: no
// shape changes by that. Nothing else moves but the p + 1 control points at the joint's ends: at
// most half the gap. Throws std::invalid_argument if the tolerance is negative or not a number, or
// the gap is larger.
template <int Dim>
NurbsCurve<Dim> Join(const NurbsCurve<Dim>& first, const NurbsCurve<Dim>& second, double tolerance);

// The same of surfaces across the upper edge of the first and the lower edge of the second in
// `direction`. In the other direction the second's domain is scaled to the first's, degrees are
// raised and knots merged (knots of the second within 1e-12 of the domain's length of a knot of the
// first become that); it stays periodic where both are over the same knots and is clamped
// otherwise. The edges must agree within the tolerance at equal parameters, the bound of their
// distance counting, and rational ones also in the proportions of their weights. Throws
// std::invalid_argument if a surface is trimmed.
NurbsSurface Join(const NurbsSurface& first,
                  const NurbsSurface& second,
                  Direction direction,
                  double tolerance);

}  // namespace batten
