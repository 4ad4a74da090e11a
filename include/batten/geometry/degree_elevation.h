// SPDX-License-Identifier: MIT
// Degree elevation of curves and surfaces.
#pragma once

#include "batten/geometry/direction.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// The same curve with the same parameter as a spline of degree q = p + by. Every knot is repeated
// `by` times more; where that makes more than q + 1 knots up to an end of the domain, the outermost
// are left out. Clamped, unclamped and periodic ends stay what they are.
//
// Every new control point is a mean of given ones with weights ≥ 0, in homogeneous coordinates,
// taken in `by` steps of one degree. So it lies in their hull, control points that coincide give
// control points that coincide with them, and rounding moves no control point and no point of the
// shape in any coordinate by more than by·ε·(8(q+1)·D + |P|), ε = 2^-52, D the range of the
// coordinate over all control points and |P| its largest absolute value, whatever the weights and
// knots are; new weights are right to 4·by·(q+1)·ε of themselves. (Over a periodic basis whose
// knots repeat only to rounding δ, the seam moves by the order of δ over the length of the spans
// next to it.)
//
// by = 0 returns the shape itself. Throws std::invalid_argument when by is negative or q is above
// kMaxDegree. O(by·n·q³) for n control points. [Piegl & Tiller 1997, §5.5, A5.9, by the polar form:
// Ramshaw 1989; Liu 1997]
template <int Dim>
NurbsCurve<Dim> Elevated(const NurbsCurve<Dim>& curve, int by);

// The same in one direction of a surface.
NurbsSurface Elevated(const NurbsSurface& surface, Direction direction, int by);

}  // namespace batten
