// SPDX-License-Identifier: MIT
// Cubic spline interpolation: C² curves through points, with knots at their parameters.
#pragma once

#include <Eigen/Core>

#include "batten/geometry/nurbs_curve.h"

namespace batten {

enum class CubicEnd {
  kNotAKnot,           // the third derivative is continuous at the second point from the end
  kNatural,            // the second derivative vanishes
  kFirstDerivative,    // is given (clamped)
  kSecondDerivative,   // is given
  kCurvature,          // is given
  kFunctionCurvature,  // is given, of a function of the first coordinate, which is the parameter:
                       // that one's second derivative stays zero
};

template <int Dim>
struct CubicEndCondition {
  CubicEnd kind = CubicEnd::kNotAKnot;
  // The derivative; of curvatures in space the curvature vector, one over the radius long and
  // towards the centre, of which the part across the curve counts; in the plane (κ, 0), κ > 0 where
  // the curve turns left.
  Eigen::Matrix<double, Dim, 1> value = Eigen::Matrix<double, Dim, 1>::Zero();
};

// A spline's derivatives at its points (Dim × m each).
template <int Dim>
struct SplineDerivatives {
  Eigen::Matrix<double, Dim, Eigen::Dynamic> slopes, moments;  // the first and the second
};

// The cubic spline through points (Dim × m, m ≥ 2) at increasing parameters t, by its slopes: the
// first derivatives m_k solve λ m_{k−1} + 2 m_k + μ m_{k+1} = 3 (λ d_{k−1} + μ d_k), with h_k =
// t_{k+1} − t_k, d_k = (q_{k+1} − q_k)/h_k, λ = h_k/(h_{k−1} + h_k), μ = 1 − λ, and the ends'
// conditions; the second derivatives follow from them. A function y(x) is the curve (x, y) at the
// parameters x.
//  (1) Between two points without further conditions it is the straight line, between three the
//      parabola.
//  (2) The natural spline has the least ∫ |C''|² of all curves through the points at these
//      parameters.
//  (3) Curvatures are met to 1e-12, by Newton's method for the second derivatives at the ends,
//      from the spline without them on.
//
// O(m). Throws std::invalid_argument, with a sentence for the user, if sizes disagree, something is
// not finite, parameters do not increase, and where no spline with the curvatures is found: great
// ones may have none. [de Boor 1978, IV; Piegl & Tiller 1997, §9.2.3]
template <int Dim>
SplineDerivatives<Dim> SplineBySlopes(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                                      const Eigen::VectorXd& parameters,
                                      const CubicEndCondition<Dim>& start = {},
                                      const CubicEndCondition<Dim>& end = {});

// The same spline by its moments: the second derivatives M_k solve μ M_{k−1} + 2 M_k + λ M_{k+1} =
// 6 (d_k − d_{k−1})/(h_{k−1} + h_k) and the ends' conditions; slopes follow from them. Equal to
// SplineBySlopes to rounding.
template <int Dim>
SplineDerivatives<Dim> SplineByMoments(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                                       const Eigen::VectorXd& parameters,
                                       const CubicEndCondition<Dim>& start = {},
                                       const CubicEndCondition<Dim>& end = {});

// The periodic spline through m ≥ 3 points at the first m of m + 1 increasing parameters, at the
// last of which it is back at the first point.
template <int Dim>
SplineDerivatives<Dim> ClosedSplineBySlopes(
    const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points, const Eigen::VectorXd& parameters);
template <int Dim>
SplineDerivatives<Dim> ClosedSplineByMoments(
    const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points, const Eigen::VectorXd& parameters);

// That spline as a B-spline curve, with a simple knot at every point but those that are no knots;
// closed: periodic. Control points are blossoms of the pieces: at a point q with the knots h before
// and h' behind it q + m (h' − h)/3 − M h h'/6. Meets points and conditions to rounding.
template <int Dim>
NurbsCurve<Dim> CubicSplineCurve(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                                 const Eigen::VectorXd& parameters,
                                 const CubicEndCondition<Dim>& start = {},
                                 const CubicEndCondition<Dim>& end = {});
template <int Dim>
NurbsCurve<Dim> ClosedCubicSplineCurve(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                                       const Eigen::VectorXd& parameters);

// The periodic function through m ≥ 4 points at their first coordinates, the parameters but for a
// shift: over one period from the first point to the last, whose other coordinates are the first's,
// and there the first and second derivatives are the same too. The curve (x, y), open. Throws as
// above, and where those coordinates differ by more than 1e-9 of their extent.
template <int Dim>
NurbsCurve<Dim> PeriodicFunctionCurve(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                                      const Eigen::VectorXd& parameters);

}  // namespace batten
