// SPDX-License-Identifier: MIT
// One cubic or quintic segment on [0, 1] in its equivalent forms.
#pragma once

#include <Eigen/Core>

#include "batten/geometry/bezier_curve.h"

namespace batten {

// End points and end derivatives of a cubic: Ferguson's form. [Ferguson 1964]
template <int Dim>
struct CubicHermite {
  Eigen::Matrix<double, Dim, 1> start, start_derivative, end, end_derivative;
};

// The same with second derivatives, of a quintic.
template <int Dim>
struct QuinticHermite {
  Eigen::Matrix<double, Dim, 1> start, start_derivative, start_second;
  Eigen::Matrix<double, Dim, 1> end, end_derivative, end_second;
};

// The four control points of one span of a uniform cubic B-spline, columns in order.
template <int Dim>
struct UniformCubicSegment {
  Eigen::Matrix<double, Dim, 4> control_points;
};

// The Bézier form, and back. Each is one linear map; rounding is some ε of the largest value. The
// way back throws std::invalid_argument unless the curve is of degree 3 (5) without weights.
// [Piegl & Tiller 1997, §1.3; Farin 2002, §7.5, §8.7]
template <int Dim>
BezierCurve<Dim> ToBezier(const CubicHermite<Dim>& segment);
template <int Dim>
BezierCurve<Dim> ToBezier(const QuinticHermite<Dim>& segment);
template <int Dim>
BezierCurve<Dim> ToBezier(const UniformCubicSegment<Dim>& segment);
template <int Dim>
CubicHermite<Dim> CubicHermiteOf(const BezierCurve<Dim>& curve);
template <int Dim>
QuinticHermite<Dim> QuinticHermiteOf(const BezierCurve<Dim>& curve);
template <int Dim>
UniformCubicSegment<Dim> UniformCubicSegmentOf(const BezierCurve<Dim>& curve);

}  // namespace batten
