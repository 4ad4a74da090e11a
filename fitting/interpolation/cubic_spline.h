// SPDX-License-Identifier: MIT
// Cubic spline interpolation: C² curves through points, with knots at their parameters.
#pragma once

#include <Eigen/Core>

#include "batten/geometry/nurbs_curve.h"

namespace batten::internal {

enum class CubicEnd {
  kNotAKnot,          // the third derivative is continuous at the second point from the end
  kNatural,           // the second derivative vanishes
  kFirstDerivative,   // is given (clamped)
  kSecondDerivative,  // is given
};

template <int Dim>
struct CubicEndCondition {
  CubicEnd kind = CubicEnd::kNotAKnot;
  Eigen::Matrix<double, Dim, 1> value = Eigen::Matrix<double, Dim, 1>::Zero();
};

// The cubic spline through points (Dim × m, m ≥ 2) at increasing parameters. Between two
// points without further conditions it is the straight line, between three the parabola.
// Its natural form has the least ∫ |C''|² of all curves through the points at these parameters.
// O(m). Throws std::invalid_argument if sizes disagree, something is not finite or parameters do
// not increase. [de Boor 1978, IV; Piegl & Tiller 1997, §9.2.3]
template <int Dim>
NurbsCurve<Dim> CubicSplineCurve(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                                 const Eigen::VectorXd& parameters,
                                 const CubicEndCondition<Dim>& start = {},
                                 const CubicEndCondition<Dim>& end = {});

// The periodic cubic spline through m ≥ 3 points at the first m of m + 1 increasing parameters, at
// the last of which it is back at the first point. O(m). Throws as CubicSplineCurve does.
template <int Dim>
NurbsCurve<Dim> ClosedCubicSplineCurve(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                                       const Eigen::VectorXd& parameters);

}  // namespace batten::internal
