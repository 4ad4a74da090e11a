// SPDX-License-Identifier: MIT
// Knot insertion and refinement: more control points, the same shape.
#pragma once

#include <span>

#include "batten/geometry/direction.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// The same shape over the knots with `u` (`at`) inserted `times` times. The knot may be any
// parameter of the closed domain whose multiplicity stays at most the degree p: ends of an
// unclamped domain too, and the seam of a periodic one, where both ends are the same knot. What is
// periodic stays periodic. Throws std::invalid_argument if the parameter is outside the domain, not
// a number, or would be repeated more than p times, and if times < 1.
// [Boehm 1980; Piegl & Tiller 1997, A5.1, A5.3]
//
// Rounding: with ε = 2^-52 and D the range of a coordinate over the p + 1 control points that act
// at u, each coordinate of each new control point is right to (6p + 3)·ε·D + ε·|P| and its weight
// to (3p + 1)·ε of itself, so no point of the shape moves by more than (12p + 5)·ε·D + ε·|P|. That
// holds for any weights and any knots. Over a periodic basis the repeated knots are rounded, and
// their part comes on top. Control points that are not concerned stay bit by bit. O(n + p³), times
// the size of the other direction.
template <int Dim>
NurbsCurve<Dim> InsertKnot(const NurbsCurve<Dim>& curve, double u, int times = 1);
NurbsSurface InsertKnot(const NurbsSurface& surface, Direction direction, double at, int times = 1);

// The same for many knots at once, in any order, a value as often as it is to be inserted; none is
// allowed. The rounding bound is that of one insertion, however many knots. [A5.4, A5.5]
template <int Dim>
NurbsCurve<Dim> RefineKnots(const NurbsCurve<Dim>& curve, std::span<const double> knots);
NurbsSurface RefineKnots(const NurbsSurface& surface,
                         Direction direction,
                         std::span<const double> knots);

}  // namespace batten
