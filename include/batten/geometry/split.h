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

// The trims of a surface are cut where they cross the line, exactly, and joined along it by
// straight pieces of loops; a piece that they fill has none. What comes to within 1e-10 of the
// domain of the line ends there. A piece of the surface in which several parts count, or nothing,
// is not one surface: Split and Segment throw std::invalid_argument and SegmentParts and Decompose
// give one surface for each part, which have the piece in common and other trims.

// The pieces below and above u. Throws std::invalid_argument unless u is strictly inside the
// domain. [Piegl & Tiller 1997, §5.2]
template <int Dim>
std::pair<NurbsCurve<Dim>, NurbsCurve<Dim>> Split(const NurbsCurve<Dim>& curve, double u);
std::pair<NurbsSurface, NurbsSurface> Split(const NurbsSurface& surface,
                                            Direction direction,
                                            double at);

// The piece over [a, b], or [a, b] × [c, d]. Throws std::invalid_argument unless lower ≤ a < b ≤
// upper. Over a periodic basis b may pass the end by less than a period, b ≤ a + period: the piece
// then runs through the seam, which is refused for a trimmed surface.
template <int Dim>
NurbsCurve<Dim> Segment(const NurbsCurve<Dim>& curve, double a, double b);
NurbsSurface Segment(const NurbsSurface& surface, double a, double b, double c, double d);
NurbsSurface Segment(const NurbsSurface& surface, Direction direction, double a, double b);

// The piece over [a, b] once for every connected part of it that counts: once where the surface is
// not trimmed, none where its trims leave nothing.
std::vector<NurbsSurface> SegmentParts(const NurbsSurface& surface,
                                       Direction direction,
                                       double a,
                                       double b);

// The Bézier pieces, one for each span that is not empty, in order; those of a surface span by
// span in v for each span in u. Pieces of a surface in which nothing counts are left out. [A5.6,
// A5.7]
template <int Dim>
std::vector<NurbsCurve<Dim>> Decompose(const NurbsCurve<Dim>& curve);
std::vector<NurbsSurface> Decompose(const NurbsSurface& surface);
std::vector<NurbsSurface> Decompose(const NurbsSurface& surface, Direction direction);

}  // namespace batten
