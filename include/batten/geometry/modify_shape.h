// SPDX-License-Identifier: MIT
// Changes of shape by hand: weights, and one point to pass through.
#pragma once

#include <span>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// The shape with one weight replaced, control points and knots unchanged: points are pulled towards
// the control point (a greater weight) or pushed away from it (a smaller one) along straight lines.
// Over a periodic basis every copy of the control point takes the weight, and where the shape
// closes over a clamped basis the one it coincides with keeps its ratio to it. Throws
// std::invalid_argument if there is no such control point or the weight is not positive and finite.
// [Piegl & Tiller 1997, §11.3]
template <int Dim>
NurbsCurve<Dim> WithWeight(const NurbsCurve<Dim>& curve, int i, double weight);
NurbsSurface WithWeight(const NurbsSurface& surface, int i, int j, double weight);

// The shape whose point at this parameter is moved by `by` (data's units; negative: pushed away)
// through the weight of one control point, on curves also of two neighbours i and i + 1 that keep
// their ratio. The point moves straight towards the control point or, of two, towards the point of
// their leg on which it would lie if they alone acted. With R the point where those weights are
// zero, Q the one it moves towards, P the old and P' the new one the factor of the weights is the
// cross-ratio (|RP'|/|P'Q|) / (|RP|/|PQ|). Control points and knots stay; copies
// take the weight too, as above. Throws std::invalid_argument where a control point is not there or
// does not act at the parameter, and where `by` reaches Q, so that the weight would be infinite, or
// R, where it would not be positive: the message says how far they are. [Piegl & Tiller 1997,
// §11.3.1, §11.3.2]
template <int Dim>
NurbsCurve<Dim> Pulled(const NurbsCurve<Dim>& curve,
                       double u,
                       std::span<const int> control_points,
                       double by);
NurbsSurface Pulled(const NurbsSurface& surface, double u, double v, int i, int j, double by);

// The shape that has the point `to` at this parameter, with the least change: of all moves of
// control points that do it, the one whose squares of distances sum to least. Only the control
// points that act there move, all along the same direction, in proportion to their rational basis
// functions R: ΔP_i = R_i / Σ R_j² · (to − C(u)). Weights and knots stay bit by bit. Copies of
// a control point over a periodic basis move together and count once, as do those that coincide
// because the shape closes over a clamped basis or an edge of it is a point: it stays closed. The
// new shape has `to` to 8(p + 1)·ε of the largest coordinate (on surfaces the product of both p +
// 1). Throws std::invalid_argument if the parameter is outside the domain (in a periodic direction
// it is wrapped) or `to` is not finite. [Piegl & Tiller 1997, §11.2, §11.5]
template <int Dim>
NurbsCurve<Dim> MovedPoint(const NurbsCurve<Dim>& curve,
                           double u,
                           const typename NurbsCurve<Dim>::Point& to);
NurbsSurface MovedPoint(const NurbsSurface& surface, double u, double v, const Eigen::Vector3d& to);

}  // namespace batten
