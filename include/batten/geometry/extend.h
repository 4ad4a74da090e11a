// SPDX-License-Identifier: MIT
// Curves and surfaces continued past an end or an edge.
#pragma once

#include "batten/geometry/joins.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// How a shape of degree p goes on past its end.
//  kFair: its second derivative stays what it is at the end, so the third is zero, the
//  least there
//    can be: a parabola for p ≥ 2, a straight line for p = 1. For p ≥ 3 the end becomes a knot of
//    multiplicity p − 2, across which the shape is C².
//  kNatural: the polynomial of the last span goes on; no knot is added. Over spans that are short
//    against the extension it may swing widely.
// For p ≤ 2 the two are the same. A rational shape goes on as the same rational piece in both: a
// cylinder stays a cylinder.
enum class Continuation { kFair, kNatural };

// The curve with a piece of arc length `length` (in the data's units, to 1e-9 of it) beyond the
// upper or lower end of its domain, which grows by what that takes. The old part stays the same
// function of its parameter, to 1e-13 of the size where the extension is not longer than the shape;
// control points that do not act at the end stay bit by bit. An unclamped end is clamped first.
//
// Throws std::invalid_argument unless 0 < length < ∞; where the curve is closed or periodic; where
// it comes to rest at the end; where the parameters are too large for so short a piece; and where a
// weight would fall below 1/100 of the least at the end: the message then names the greatest length
// that works. O(p²) and some dozen arc lengths.
template <int Dim>
NurbsCurve<Dim> Extended(const NurbsCurve<Dim>& curve,
                         bool upper,
                         double length,
                         Continuation continuation = Continuation::kFair);

// The surface with a strip beyond one of its edges. `length` is the mean arc length, over the
// parameter along the edge, of the added parts of the iso-lines that cross it, to 1e-6 of it. The
// strip's width varies where the speed of the iso-lines does. Trim loops stay what they are: the
// domain grows, the trimmed part does not. Throws as above, and where the surface is closed or
// periodic across the edge or the edge is collapsed to a point. A dozen arc lengths for each of
// some dozen iso-lines in every span of the edge.
NurbsSurface Extended(const NurbsSurface& surface,
                      const SurfaceEdge& edge,
                      double length,
                      Continuation continuation = Continuation::kFair);

}  // namespace batten
