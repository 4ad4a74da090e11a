// SPDX-License-Identifier: MIT
// Least-squares spline curves under exact linear conditions.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "batten/geometry/nurbs_curve.h"

namespace batten {

// A condition on the curve, or its derivative of an order, at a parameter: met exactly, or weighted
// along with the data.
struct CurveCondition {
  double u = 0;
  int order = 0;          // 0 … degree
  Eigen::VectorXd value;  // data's units by the parameter's to the power of the order
  std::optional<double> weight = std::nullopt;  // of its squared distance, > 0; exact when absent
};

// The control points (d × n, periodic ones with the first p repeated) over the basis with the least
// Σ w_k |C(u_k) − q_k|² + Σ w |C^(r)(u) − value|² among those that meet every exact condition.
// parameters: m in the basis' domain, in any order; values q: d × m; weights: m, not negative, or
// none for ones. Derivatives are taken from the right, at the upper end from the left.
// Lagrange multipliers stand among the control points they act on, so that the equations are
// banded; their solution is refined by residuals of the data. Exact conditions are met to rounding
// times the size of the control points. O(m·p² + (n + c)·(p + c_p)²), with c conditions, c_p of
// them in p + 1 spans at most; periodic O(n·c²) more. Throws std::invalid_argument where sizes
// disagree or numbers are not finite, a parameter leaves the domain, an exact condition follows
// from the others or contradicts them (which one, by its place and index), and where data and
// conditions leave control points undetermined (where). [Piegl & Tiller 1997, A9.6, §9.4.2]
Eigen::MatrixXd ConstrainedLeastSquares(const SplineBasis& basis,
                                        const Eigen::VectorXd& parameters,
                                        const Eigen::MatrixXd& values,
                                        const Eigen::VectorXd& weights = {},
                                        const std::vector<CurveCondition>& conditions = {});

// ConstrainedLeastSquares as a curve in the plane or in space.
template <int Dim>
NurbsCurve<Dim> ConstrainedCurve(const SplineBasis& basis,
                                 const Eigen::VectorXd& parameters,
                                 const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                                 const Eigen::VectorXd& weights = {},
                                 const std::vector<CurveCondition>& conditions = {}) {
  return NurbsCurve<Dim>(basis,
                         ConstrainedLeastSquares(basis, parameters, points, weights, conditions));
}

}  // namespace batten
