// SPDX-License-Identifier: MIT
#include "batten/geometry/nurbs_curve.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

#include "geometry/nurbs/rational_derivatives.h"

namespace batten {
using namespace internal;

namespace {

constexpr double kLargest = std::numeric_limits<double>::max();

// The control points that act on a span, less one of them (an end of the span's own), and weights.
template <int Dim>
struct ActivePoints {
  using Point = Eigen::Matrix<double, Dim, 1>;

  ActivePoints(const NurbsCurve<Dim>& curve, int span, double u)
      : count(curve.basis().degree() + 1),
        points(curve.control_points().col(span - count + 1).data()),
        weights(curve.rational() ? curve.weights().data() + span - count + 1 : nullptr),
        origin(Eigen::Map<const Point>(points + (AtUpperHalf(curve, span, u) ? p() * Dim : 0))) {}

  // Which end of the span is nearer: a clamped end is met exactly from its own control point.
  static bool AtUpperHalf(const NurbsCurve<Dim>& curve, int span, double u) {
    const double* knots = curve.basis().knots().data() + span;
    return u - knots[0] > knots[1] - u;
  }

  int p() const { return count - 1; }
  Point Offset(int r) const { return Eigen::Map<const Point>(points + r * Dim) - origin; }

  // Σ N_r w_r (P_r − origin, 1); without weights the last component is not meant.
  Eigen::Matrix<double, Dim + 1, 1> Sum(const double* N) const {
    Point sum = Point::Zero();
    double weight = 0;
    for (int r = 0; r < count; ++r) {
      const double c = weights ? N[r] * weights[r] : N[r];
      sum += c * Offset(r);
      weight += c;
    }
    Eigen::Matrix<double, Dim + 1, 1> result;
    result << sum, weight;
    return result;
  }

  int count;
  const double* points;
  const double* weights;  // none if all are equal
  Point origin;
};

}  // namespace

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
  const Points range = control_points_.colwise() - control_points_.col(0);
  if (!(weights_.maxCoeff() * (2 * range.cwiseAbs().maxCoeff()) <= kLargest)) {
    throw std::invalid_argument("NurbsCurve: control points times weights are too far apart");
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
  const int span = basis_.Span(u);
  double N[kMaxDegree + 1];
  basis_.Values(span, u, N);
  const ActivePoints<Dim> active(*this, span, u);
  const Eigen::Matrix<double, Dim + 1, 1> sum = active.Sum(N);
  if (!rational_) return active.origin + sum.template head<Dim>();
  return active.origin + sum.template head<Dim>() / sum[Dim];
}

// Leibniz' rule for w·(C − origin), solved for the derivatives of C. [A4.2 for order 3]
template <int Dim>
CurveJet<Dim> NurbsCurve<Dim>::JetAt(double u) const {
  u = basis_.Clamp(u);
  const int span = basis_.Span(u), p = basis_.degree();
  double N[4 * (kMaxDegree + 1)];
  basis_.Derivatives(span, u, 3, N);
  const ActivePoints<Dim> active(*this, span, u);
  Eigen::Matrix<double, Dim + 1, 1> a[4];
  for (int k = 0; k < 4; ++k) a[k] = active.Sum(N + k * (p + 1));
  const auto lead = [&](int k) -> Point { return a[k].template head<Dim>(); };
  if (!rational_) return {active.origin + lead(0), lead(1), lead(2), lead(3)};
  const double w = a[0][Dim], w1 = a[1][Dim], w2 = a[2][Dim], w3 = a[3][Dim];
  const Point c = lead(0) / w;
  CurveJet<Dim> jet;
  jet.point = active.origin + c;
  jet.first = (lead(1) - w1 * c) / w;
  jet.second = (lead(2) - 2 * w1 * jet.first - w2 * c) / w;
  jet.third = (lead(3) - 3 * w1 * jet.second - 3 * w2 * jet.first - w3 * c) / w;
  return jet;
}

template <int Dim>
typename NurbsCurve<Dim>::Points NurbsCurve<Dim>::Derivatives(double u, int order) const {
  if (order < 0) throw std::invalid_argument("NurbsCurve::Derivatives: order is negative");
  u = basis_.Clamp(u);
  const int span = basis_.Span(u), p = basis_.degree(), top = std::min(order, p);
  double N[(kMaxDegree + 1) * (kMaxDegree + 1)];
  basis_.Derivatives(span, u, top, N);
  const ActivePoints<Dim> active(*this, span, u);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(Dim + 1, Eigen::Index{order} + 1);
  for (int k = 0; k <= top; ++k) A.col(k) = active.Sum(N + k * (p + 1));
  if (rational_) RationalCurveDerivatives(A);
  A.col(0).template head<Dim>() += active.origin;
  return A.template topRows<Dim>();
}

template class NurbsCurve<2>;
template class NurbsCurve<3>;

}  // namespace batten
