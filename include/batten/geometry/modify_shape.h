// SPDX-License-Identifier: MIT
// Changes of shape by hand: one weight, one point to pass through.
#pragma once

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// The shape with one weight replaced, control points and knots unchanged: points are pulled towards
// the control point (a greater weight) or pushed away from it (a smaller one) along straight lines.
// Over a periodic basis every copy of the control point takes the weight. Throws
// std::invalid_argument if there is no such control point or the weight is not positive and finite.
// [Piegl & Tiller 1997, §11.3]
template <int Dim>
NurbsCurve<Dim> WithWeight(const NurbsCurve<Dim>& curve, int i, double weight);
NurbsSurface WithWeight(const NurbsSurface& surface, int i, int j, double weight);

// The shape that has the point `to` at this parameter, with the least change: of all moves of
// control points that do it, the one whose squares of distances sum to least. Only the control
// points that act there move, all along the same direction, in proportion to their rational basis
// functions R: ΔP_i = R_i / Σ R_j² · (to − C(u)). Weights and knots stay bit by bit; over a
// periodic basis copies of a control point move together and count once. The new shape has `to` to
// 8(p + 1)·ε of the largest coordinate (on surfaces the product of both p + 1).
// Throws std::invalid_argument if the parameter is outside the domain (in a periodic direction it
// is wrapped) or `to` is not finite. [Piegl & Tiller 1997, §11.2, §11.5]
template <int Dim>
NurbsCurve<Dim> MovedPoint(const NurbsCurve<Dim>& curve,
                           double u,
                           const typename NurbsCurve<Dim>::Point& to);
NurbsSurface MovedPoint(const NurbsSurface& surface, double u, double v, const Eigen::Vector3d& to);

}  // namespace batten
