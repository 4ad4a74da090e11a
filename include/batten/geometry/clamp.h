// SPDX-License-Identifier: MIT
// Clamped, unclamped and periodic forms of the same shape.
#pragma once

#include "batten/geometry/direction.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// The same shape with both end knots p + 1 times: it begins and ends at control points. A periodic
// shape becomes a closed one. Clamped already: returned as it is. Rounding is that of knot
// insertion (insert_knots.h). [Piegl & Tiller 1997, §12.2]
template <int Dim>
NurbsCurve<Dim> Clamped(const NurbsCurve<Dim>& curve);
NurbsSurface Clamped(const NurbsSurface& surface, Direction direction);

// The same shape with end knots outside the domain: at each clamped end the p outer knots continue
// the inner spans of the other end, as over a periodic basis. Ends that are not clamped, and
// periodic shapes, stay as they are.
// The new control points are extrapolated. If one of them gets a weight that is not positive, or
// moves away from the end by more than 1000 times the extent of the p + 1 points there (weights
// likewise more than 1000-fold), the outer spans are halved until none does; throws
// std::invalid_argument where that does not help. Rounding: the shape moves by at most
// 64·p·ε·G, with ε = 2^-52 and G the largest homogeneous coordinate of the new control points over
// their smallest weight. [Piegl & Tiller 1997, A12.1]
template <int Dim>
NurbsCurve<Dim> Unclamped(const NurbsCurve<Dim>& curve);
NurbsSurface Unclamped(const NurbsSurface& surface, Direction direction);

// The periodic form of a closed shape: the seam is an inner knot of the multiplicity that the
// continuity found there leaves (p if it is only C^0, one if it is C^{p-1}), the same shape within
// `tolerance` (≥ 0, in the data's units). Continuity is that of the homogeneous form, which the
// periodic form is made of: a full circle of nine points is C^0 there. Unclamped input is clamped
// first; periodic input comes back as it is.
// Throws std::invalid_argument if the tolerance is negative or not a number, and unless the ends
// meet within it, weights included. [Piegl & Tiller 1997, §12.2]
template <int Dim>
NurbsCurve<Dim> Periodic(const NurbsCurve<Dim>& curve, double tolerance);
NurbsSurface Periodic(const NurbsSurface& surface, Direction direction, double tolerance);

}  // namespace batten
