// SPDX-License-Identifier: MIT
// The same shape run through the other way.
#pragma once

#include "batten/geometry/direction.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// The shape at lower + upper − u is the old one at u, on the same domain. Control points and
// weights change places bit by bit; knots are rounded to one unit in the last place of the largest,
// the ends not at all. What is periodic stays periodic. Trims are mirrored with the domain and
// turned again, also in Swapped. [Piegl & Tiller 1997, §6.3]
template <int Dim>
NurbsCurve<Dim> Reversed(const NurbsCurve<Dim>& curve);
NurbsSurface Reversed(const NurbsSurface& surface, Direction direction);

// u and v exchanged, exactly: the surface at (v, u) is the old one at (u, v); normals turn round.
NurbsSurface Swapped(const NurbsSurface& surface);

}  // namespace batten
