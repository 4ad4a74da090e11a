// SPDX-License-Identifier: MIT
#include "batten/geometry/nurbs_curve.h"

#include <stdexcept>
#include <string>

#include "batten/geometry/rational_derivatives.h"

namespace batten {

template <int Dim>
NurbsCurve<Dim>::NurbsCurve(SplineBasis basis, Points control_points, Eigen::VectorXd weights)
    : basis_(std::move(basis)),
      control_points_(std::move(control_points)),
      weights_(std::move(weights)) {
  if (weights_.size() == 0) weights_ = Eigen::VectorXd::Ones(basis_.size());
  if (control_points_.cols() != basis_.size()) {
    throw std::invalid_argument("NurbsCurve: " + std::to_string(control_points_.cols()) +
                                " control points do not fit a basis of " +
                                std::to_string(basis_.size()) + " functions");
  }
  if (weights_.size() != basis_.size()) {
    throw std::invalid_argument("NurbsCurve: " + std::to_string(weights_.size()) +
                                " weights do not fit " + std::to_string(basis_.size()) +
                                " control points");
  }
  if (!control_points_.allFinite()) {
    throw std::invalid_argument("NurbsCurve: a control point is not finite");
  }
  if (!weights_.allFinite() || !(weights_.minCoeff() > 0)) {
    throw std::invalid_argument("NurbsCurve: a weight is not positive and finite");
  }
  rational_ = (weights_.array() != weights_[0]).any();
  if (basis_.periodic()) {
    const int p = basis_.degree();
    if (control_points_.leftCols(p) != control_points_.rightCols(p) ||
        weights_.head(p) != weights_.tail(p)) {
      throw std::invalid_argument("NurbsCurve: the last " + std::to_string(p) +
                                  " control points of a periodic curve do not repeat the first");
    }
  }
}

template <int Dim>
typename NurbsCurve<Dim>::Point NurbsCurve<Dim>::At(double u) const {
  u = basis_.Clamp(u);
  const int p = basis_.degree();
  const int span = basis_.Span(u);
  double N[kMaxDegree + 1];
  basis_.Values(span, u, N);
  Point sum = Point::Zero();
  double weight = 0;
  for (int r = 0; r <= p; ++r) {
    const double c = N[r] * weights_[span - p + r];
    sum += c * control_points_.col(span - p + r);
    weight += c;
  }
  return sum / weight;
}

template <int Dim>
typename NurbsCurve<Dim>::Points NurbsCurve<Dim>::Derivatives(double u, int order) const {
  if (order < 0) throw std::invalid_argument("NurbsCurve::Derivatives: order is negative");
  u = basis_.Clamp(u);
  const int p = basis_.degree();
  const int span = basis_.Span(u);
  std::vector<double> N((order + 1) * (p + 1));
  basis_.Derivatives(span, u, order, N.data());
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(Dim + 1, order + 1);
  for (int k = 0; k <= order; ++k) {
    for (int r = 0; r <= p; ++r) {
      const int i = span - p + r;
      const double c = N[k * (p + 1) + r] * weights_[i];
      A.col(k).template head<Dim>() += c * control_points_.col(i);
      A(Dim, k) += c;
    }
  }
  RationalCurveDerivatives(A);
  return A.template topRows<Dim>();
}

template class NurbsCurve<2>;
template class NurbsCurve<3>;

}  // namespace batten
