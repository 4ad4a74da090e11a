// SPDX-License-Identifier: MIT
#include "batten/geometry/bezier_reduction.h"

#include <stdexcept>
#include <string>

#include "geometry/editing/deviation_bound.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten {
using namespace internal;
namespace {

// Q_0 … Q_{n−1} one after the other from P_i = (i/n) Q_{i−1} + (1 − i/n) Q_i. [eq. 5.41]
Eigen::MatrixXd Forward(const Eigen::MatrixXd& P) {
  const Eigen::Index n = P.cols() - 1;
  Eigen::MatrixXd Q(P.rows(), n);
  Q.col(0) = P.col(0);
  for (Eigen::Index i = 1; i < n; ++i) {
    Q.col(i) = (double(n) * P.col(i) - double(i) * Q.col(i - 1)) / double(n - i);
  }
  return Q;
}

Eigen::MatrixXd NearestInSquares(const Eigen::MatrixXd& P,
                                 const Eigen::VectorXd& weights,
                                 bool fixed_ends) {
  const Eigen::Index n = P.cols() - 1;
  Eigen::MatrixXd E = Eigen::MatrixXd::Zero(n + 1, n);
  for (Eigen::Index i = 0; i <= n; ++i) {
    if (i > 0) E(i, i - 1) = double(i) / double(n);
    if (i < n) E(i, i) = double(n - i) / double(n);
  }
  Eigen::MatrixXd Q = Eigen::MatrixXd::Zero(n, P.rows());
  const Eigen::Index fixed = fixed_ends ? 1 : 0, free = n - 2 * fixed;
  if (fixed_ends) {
    Q.row(0) = P.col(0).transpose();
    Q.row(n - 1) = P.col(n).transpose();
  }
  if (free > 0) {
    const Eigen::VectorXd scale = weights.cwiseInverse();
    const Eigen::MatrixXd rest = scale.asDiagonal() * (P.transpose() - E * Q);
    Q.middleRows(fixed, free) = LeastSquares(scale.asDiagonal() * E.middleCols(fixed, free), rest);
  }
  return Q.transpose();
}

Eigen::MatrixXd ReducedColumns(const Eigen::MatrixXd& P,
                               const Eigen::VectorXd& weights,
                               BezierReductionRule rule) {
  switch (rule) {
    case BezierReductionRule::kForward:
      return Forward(P);
    case BezierReductionRule::kBackward:
      return Forward(P.rowwise().reverse()).rowwise().reverse();
    case BezierReductionRule::kLeastSquares:
      return NearestInSquares(P, weights, false);
    default:
      return NearestInSquares(P, weights, true);
  }
}

}  // namespace

template <int Dim>
std::optional<BezierReduction<Dim>> Reduced(const BezierCurve<Dim>& curve,
                                            BezierReductionRule rule) {
  const int least = rule == BezierReductionRule::kLeastSquaresFixedEnds ? 2 : 1;
  if (curve.degree() < least) {
    throw std::invalid_argument("Reduced: degree " + std::to_string(curve.degree()) +
                                " is less than " + std::to_string(least));
  }
  // In differences from the first control point, so that far from the origin nothing is lost.
  const Eigen::Matrix<double, Dim, 1> origin = curve.control_points().col(0);
  Eigen::MatrixXd P = Homogeneous(curve);
  P.topRows(Dim) = (curve.control_points().colwise() - origin) * P.row(Dim).asDiagonal();
  const Eigen::MatrixXd Q = ReducedColumns(P, P.row(Dim).transpose(), rule);
  if (curve.rational() && !(Q.row(Dim).minCoeff() > 0)) return {};
  const BezierCurve<Dim> about_origin = BezierFromHomogeneous<Dim>(Q, curve.rational());
  BezierCurve<Dim> reduced(about_origin.control_points().colwise() + origin,
                           about_origin.weights());
  const double error = DeviationBound(reduced, curve);
  return BezierReduction<Dim>{std::move(reduced), error};
}

template std::optional<BezierReduction<2>> Reduced(const BezierCurve<2>&, BezierReductionRule);
template std::optional<BezierReduction<3>> Reduced(const BezierCurve<3>&, BezierReductionRule);

}  // namespace batten
