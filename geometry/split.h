// SPDX-License-Identifier: MIT
// Cutting curves and surfaces at parameters.
#pragma once

#include <utility>
#include <vector>

#include "batten/geometry/direction.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// Everything here leaves the shape as it is, over its own parameters: a piece over [a, b] has the
// domain [a, b] and agrees there with the whole. Pieces are clamped in the direction that is cut,
// also those of unclamped and periodic shapes; the other direction of a surface stays as it is.
// Where two pieces meet they share control points and weights bit by bit. Rounding is that of knot
// insertion (insert_knots.h).

// The pieces below and above u. Throws std::invalid_argument unless u is strictly inside the
// domain. [Piegl & Tiller 1997, §5.2]
template <int Dim>
std::pair<NurbsCurve<Dim>, NurbsCurve<Dim>> Split(const NurbsCurve<Dim>& curve, double u);
std::pair<NurbsSurface, NurbsSurface> Split(const NurbsSurface& surface,
                                            Direction direction,
                                            double at);

// The piece over [a, b], or [a, b] × [c, d]. Throws std::invalid_argument unless lower ≤ a < b ≤
// upper. Over a periodic basis b may pass the end by less than a period, b ≤ a + period: the piece
// then runs through the seam.
template <int Dim>
NurbsCurve<Dim> Segment(const NurbsCurve<Dim>& curve, double a, double b);
NurbsSurface Segment(const NurbsSurface& surface, double a, double b, double c, double d);
NurbsSurface Segment(const NurbsSurface& surface, Direction direction, double a, double b);

// The Bézier pieces, one for each span that is not empty, in order; those of a surface span by
// span in v for each span in u. [A5.6, A5.7]
template <int Dim>
std::vector<NurbsCurve<Dim>> Decompose(const NurbsCurve<Dim>& curve);
std::vector<NurbsSurface> Decompose(const NurbsSurface& surface);
std::vector<NurbsSurface> Decompose(const NurbsSurface& surface, Direction direction);

}  // namespace batten
