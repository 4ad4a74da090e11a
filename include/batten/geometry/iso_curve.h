// SPDX-License-Identifier: MIT
// Curves on a surface along which one parameter is fixed.
#pragma once

#include <array>

#include "batten/geometry/direction.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// The curve along which the parameter of `direction` is fixed: IsoCurve(S, Direction::kU, a) is
// v ↦ S(a, v), over the basis of v, periodic where that is; IsoCurve(S, Direction::kV, b) is
// u ↦ S(u, b). Its control points are convex combinations of those of the surface, so it is right
// to 4p·ε of the largest coordinate; at an end of a clamped direction they are the outermost row
// itself, bit by bit. The curve of a surface without weights has none.
// Throws std::invalid_argument if the parameter is outside the domain; in a periodic direction it
// is wrapped. O(p·n). [Piegl & Tiller 1997, eq. 3.14, 4.16]
NurbsCurve<3> IsoCurve(const NurbsSurface& surface, Direction direction, double parameter);

// The iso-curves at the ends of the domain: u at its lower end, u at its upper, v at its lower, v
// at its upper. An edge collapsed to a point is a curve whose control points coincide; in a closed
// direction both edges are the seam.
std::array<NurbsCurve<3>, 4> BoundaryCurves(const NurbsSurface& surface);

}  // namespace batten
