// SPDX-License-Identifier: MIT
// The one kernel of knot insertion, refinement, splitting, decomposition and clamping.
#pragma once

#include <span>
#include <vector>

#include "geometry/editing/control_rows.h"

namespace batten::internal {

// A new control point is the blossom of the spline at p consecutive new knots. Those of them that
// are old knots u_{l+1} … u_{l+s} need no work; each of the other r = p − s is blended in by one
// level of convex combinations, since it lies in [u_l, u_{l+s+1}]. The coefficients of the old
// points are sums of products of quotients of knot differences, all positive.
// [Ramshaw 1989; Piegl & Tiller 1997, A5.1–A5.5 reach the same one knot after the other]
//
// Rounding, per coordinate: with ε = 2^-52 and D the range of the coordinate over the p + 1 old
// control points that take part, a new control point is right to (6p + 3)·ε·D + ε·|P|, whatever the
// weights and however uneven or far from zero the knots; its weight to (3p + 1)·ε of itself. (A
// factor is right to 3 roundings of ε/2, a level adds two more, a sum of r + 1 terms r.) Points
// that need no work are copied. Over a periodic basis the repeated knots are themselves rounded,
// and what that does comes on top.

// The rows with the increasing knots `more` merged in; what is periodic stays so. Nothing is
// checked here but by the constructor of the basis: knots lie in the closed domain and no knot of
// the result is repeated more than p times (a clamped end: left alone). O(m·p) per new point.
ControlRows Refined(const ControlRows& rows, std::span<const double> more);

// The rows over [from, to] inside the domain as clamped rows, with the increasing knots `more` of
// ]from, to[ merged in. A periodic basis is taken as the unclamped one it also is.
ControlRows Cut(const ControlRows& rows, double from, double to, std::span<const double> more = {});

// Clamped rows over the domain with every interior knot, and every one of the increasing `breaks`,
// repeated p times: columns k·p … (k+1)·p are the Bézier points of span k.
ControlRows BezierRows(const ControlRows& rows, std::span<const double> breaks = {});

// Periodic rows written out over two periods of an unclamped basis.
ControlRows UnrolledTwice(const ControlRows& rows);

// Knots u_first … u_last of the endless sequence of which a periodic basis shows 0 … n + p.
std::vector<double> EndlessKnots(const SplineBasis& basis, int first, int last);

}  // namespace batten::internal
