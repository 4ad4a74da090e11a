// SPDX-License-Identifier: MIT
// Tangent, principal frame and signed curvature along a curve.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "batten/geometry/nurbs_curve.h"

namespace batten::internal {

// Everything here is right-continuous at knots and, at the end of the domain, the limit from the
// left, as derivatives are. Where C′ vanishes to rounding (coincident control points, cusps) it is
// the limit from that side, which the first non-vanishing derivatives give: near such a place C′ =
// t^m D(t) with D(0) ≠ 0, and T = D/|D|, κ = |D × D′| / (t^m |D|³), τ = det(D, D′, D″) / (t^m |D ×
// D′|²). Within a thousandth of a span of such an end the limit at the end stands for the value
// where that is lost to rounding. O(p²).

// The unit tangent in the direction of increasing parameters; none where the curve rests at a
// point.
template <int Dim>
std::optional<Eigen::Matrix<double, Dim, 1>> TangentAt(const NurbsCurve<Dim>& curve, double u);

// Unit vectors at right angles, binormal = tangent × normal; the normal points to the side to which
// the curve bends. [do Carmo 1976, §1.5]
struct CurveFrame {
  Eigen::Vector3d tangent, normal, binormal;
};

// The principal (Frenet) frame; a plane curve has z = 0 and its binormal is ±z. Where the curvature
// vanishes (an inflection) the limit from the same side; none where the curve is straight or rests
// at a point.
template <int Dim>
std::optional<CurveFrame> FrameAt(const NurbsCurve<Dim>& curve, double u);

// Positive where the curve bends to the left; none where CurvatureAt has none.
std::optional<double> SignedCurvatureAt(const NurbsCurve<2>& curve, double u);

extern template std::optional<Eigen::Vector2d> TangentAt(const NurbsCurve<2>&, double);
extern template std::optional<Eigen::Vector3d> TangentAt(const NurbsCurve<3>&, double);
extern template std::optional<CurveFrame> FrameAt(const NurbsCurve<2>&, double);
extern template std::optional<CurveFrame> FrameAt(const NurbsCurve<3>&, double);

}  // namespace batten::internal
