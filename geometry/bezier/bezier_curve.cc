// SPDX-License-Identifier: MIT
#include "batten/geometry/bezier_curve.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/bezier/bernstein.h"
#include "geometry/bezier/bezier_span.h"
#include "geometry/bezier/weighted_means.h"
#include "geometry/numeric/dense_solvers.h"
#include "geometry/numeric/number_text.h"
#include "geometry/numeric/reject.h"
#include "geometry/nurbs/rational_derivatives.h"

namespace batten {
using namespace internal;
namespace {

void CheckDegree(const std::string& function, Eigen::Index degree) {
  if (degree < 0 || degree > kMaxBezierDegree) {
    Reject(function,
           "degree " + std::to_string(degree) + " is not in [0, " +
               std::to_string(kMaxBezierDegree) + "]");
  }
}

// Control points as the coefficients of the given ones.
template <int Dim>
Eigen::MatrixXd Identity(const BezierCurve<Dim>& curve) {
  return Eigen::MatrixXd::Identity(curve.degree() + 1, curve.degree() + 1);
}

template <int Dim>
BezierCurve<Dim> Means(const BezierCurve<Dim>& curve, const Eigen::MatrixXd& coefficients) {
  WeightedPoints means = WeightedMeans({curve.control_points(), curve.weights()}, coefficients);
  return BezierCurve<Dim>(std::move(means.points), std::move(means.weights));
}

}  // namespace

template <int Dim>
BezierCurve<Dim>::BezierCurve(Points control_points, Eigen::VectorXd weights)
    : control_points_(std::move(control_points)), weights_(std::move(weights)) {
  CheckDegree("BezierCurve", control_points_.cols() - 1);
  if (weights_.size() == 0) weights_ = Eigen::VectorXd::Ones(control_points_.cols());
  if (weights_.size() != control_points_.cols()) {
    Reject("BezierCurve",
           std::to_string(weights_.size()) + " weights do not fit " +
               std::to_string(control_points_.cols()) + " control points");
  }
  if (!control_points_.allFinite()) Reject("BezierCurve", "a control point is not finite");
  if (!weights_.allFinite() || !(weights_.minCoeff() > 0)) {
    Reject("BezierCurve", "a weight is not positive and finite");
  }
  rational_ = (weights_.array() != weights_[0]).any();
}

template <int Dim>
typename BezierCurve<Dim>::Point BezierCurve<Dim>::At(double t) const {
  t = std::clamp(t, 0.0, 1.0);
  Points P = control_points_;
  Eigen::VectorXd w = weights_;
  for (int last = degree(); last > 0; --last) {
    for (int i = 0; i < last; ++i) {
      const double right = t * w[i + 1];
      w[i] = (1 - t) * w[i] + right;
      P.col(i) += (right / w[i]) * (P.col(i + 1) - P.col(i));
    }
  }
  return P.col(0);
}

template <int Dim>
typename BezierCurve<Dim>::Points BezierCurve<Dim>::Derivatives(double t, int order) const {
  if (order < 0) Reject("BezierCurve::Derivatives", "order is negative");
  std::vector<double> B((order + 1) * (degree() + 1));
  BernsteinDerivatives(degree(), std::clamp(t, 0.0, 1.0), order, B.data());
  const Eigen::Map<const Eigen::MatrixXd> basis(B.data(), degree() + 1, order + 1);
  if (!rational_) return control_points_ * basis;
  Eigen::MatrixXd A = Homogeneous(*this) * basis;
  RationalCurveDerivatives(A);
  return A.template topRows<Dim>();
}

// With ratios of weights r_1 = w_1/w_0, r_2 = w_2/w_0 and differences a = P_1 − P_0, b = P_2 − P_0:
// C' = n r_1 a, C'' = n(n−1) r_2 b + 2n r_1 (1 − n r_1) a.
template <int Dim>
Eigen::Matrix<double, Dim, 3> EndDerivatives(const BezierCurve<Dim>& curve, CurveEnd end) {
  const int n = curve.degree();
  const bool start = end == CurveEnd::kStart;
  const auto at = [&](int i) { return start ? i : n - i; };
  const auto& P = curve.control_points();
  const auto& w = curve.weights();
  Eigen::Matrix<double, Dim, 3> result = Eigen::Matrix<double, Dim, 3>::Zero();
  result.col(0) = P.col(at(0));
  if (n == 0) return result;
  const double r1 = w[at(1)] / w[at(0)];
  const Eigen::Matrix<double, Dim, 1> a = P.col(at(1)) - P.col(at(0));
  result.col(1) = (start ? n : -n) * r1 * a;
  result.col(2) = 2 * n * r1 * (1 - n * r1) * a;
  if (n == 1) return result;
  result.col(2) += n * (n - 1) * (w[at(2)] / w[at(0)]) * (P.col(at(2)) - P.col(at(0)));
  return result;
}

// A'w − Aw' has degree 2n−2 only; raised to 2n it has the same denominators as the weights.
template <int Dim>
BezierCurve<Dim> Hodograph(const BezierCurve<Dim>& curve) {
  using Points = typename BezierCurve<Dim>::Points;
  if (!curve.rational()) {
    return BezierCurve<Dim>(Points(BernsteinDerivative(curve.control_points())));
  }
  const int n = curve.degree();
  CheckDegree("Hodograph", 2 * n);
  const Eigen::MatrixXd A = Homogeneous(curve);
  const Eigen::RowVectorXd w = A.row(Dim);
  // In differences from the first control point, so that far from the origin nothing is lost.
  Eigen::MatrixXd numerator = A.topRows(Dim) - curve.control_points().col(0) * w;
  numerator = BernsteinProduct(BernsteinDerivative(numerator), w) -
              BernsteinProduct(numerator, BernsteinDerivative(w));
  numerator = ElevatedBernstein(numerator, 1);
  const Eigen::RowVectorXd square = BernsteinProduct(w, w);
  return BezierCurve<Dim>(Points(numerator.array().rowwise() / square.array()), square.transpose());
}

template <int Dim>
std::pair<BezierCurve<Dim>, BezierCurve<Dim>> Subdivided(const BezierCurve<Dim>& curve, double t) {
  if (!(t > 0 && t < 1)) Reject("Subdivided", "t = " + NumberText(t) + " is not inside (0, 1)");
  const auto [left, right] = SplitBernstein(Identity(curve), t);
  return {Means(curve, left), Means(curve, right)};
}

template <int Dim>
BezierCurve<Dim> Elevated(const BezierCurve<Dim>& curve, int by) {
  if (by < 0) Reject("Elevated", "by = " + std::to_string(by) + " is negative");
  CheckDegree("Elevated", Eigen::Index{curve.degree()} + by);
  return Means(curve, ElevatedBernstein(Identity(curve), by));
}

template <int Dim>
BezierCurve<Dim> InterpolatingBezierCurve(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                                          std::span<const double> parameters) {
  const Eigen::Index count = points.cols(), n = count - 1;
  CheckDegree("InterpolatingBezierCurve", n);
  if (static_cast<Eigen::Index>(parameters.size()) != count) {
    Reject("InterpolatingBezierCurve",
           std::to_string(parameters.size()) + " parameters do not fit " + std::to_string(count) +
               " points");
  }
  Eigen::MatrixXd basis(count, count);  // column k: the Bernstein polynomials at parameter k
  double last = -1;
  for (Eigen::Index k = 0; k < count; ++k) {
    const double t = parameters[k];
    if (!(t >= 0 && t <= 1 && t > last)) {
      Reject("InterpolatingBezierCurve",
             "parameter " + std::to_string(k) + " (" + NumberText(t) +
                 ") is outside [0, 1] or does not increase");
    }
    last = t;
    BernsteinValues(static_cast<int>(n), t, basis.col(k).data());
  }
  Eigen::MatrixXd control = SquareSolution(basis.transpose(), points.transpose());
  control += SquareSolution(basis.transpose(), points.transpose() - basis.transpose() * control);
  return BezierCurve<Dim>(control.transpose());
}

template <int Dim>
BezierCurve<Dim> InterpolatingBezierCurve(
    const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points) {
  std::vector<double> parameters(points.cols());
  for (size_t k = 1; k < parameters.size(); ++k) parameters[k] = double(k) / (points.cols() - 1);
  return InterpolatingBezierCurve<Dim>(points, parameters);
}

template <int Dim>
NurbsCurve<Dim> ToNurbs(const BezierCurve<Dim>& curve, double lower, double upper) {
  const double breaks[] = {lower, upper};
  return NurbsCurve<Dim>(
      SplineBasis::Clamped(curve.degree(), breaks), curve.control_points(), curve.weights());
}

template <int Dim>
BezierCurve<Dim> ToBezier(const NurbsCurve<Dim>& curve) {
  const SplineBasis& basis = curve.basis();
  const std::vector<int> spans = basis.Spans();
  if (spans.size() != 1) {
    Reject("ToBezier", "the curve has " + std::to_string(spans.size()) + " spans, not one");
  }
  const int p = basis.degree(), first = spans[0] - p;
  const BezierCurve<Dim> acting(curve.control_points().middleCols(first, p + 1),
                                curve.weights().segment(first, p + 1));
  return Means(acting, BezierSpanMatrix(basis, spans[0]).transpose());
}

template <int Dim>
Eigen::MatrixXd Homogeneous(const BezierCurve<Dim>& curve) {
  Eigen::MatrixXd columns = Eigen::MatrixXd::Ones(Dim + 1, curve.degree() + 1);
  if (curve.rational()) columns.row(Dim) = curve.weights().transpose();
  columns.topRows<Dim>() = curve.control_points() * columns.row(Dim).asDiagonal();
  return columns;
}

template <int Dim>
BezierCurve<Dim> BezierFromHomogeneous(const Eigen::MatrixXd& columns, bool rational) {
  if (!rational) return BezierCurve<Dim>(columns.topRows(Dim));
  return BezierCurve<Dim>(columns.topRows(Dim).array().rowwise() / columns.row(Dim).array(),
                          columns.row(Dim).transpose());
}

#define BATTEN_INSTANTIATE(Dim)                                                              \
  template class BezierCurve<Dim>;                                                           \
  template Eigen::Matrix<double, Dim, 3> EndDerivatives(const BezierCurve<Dim>&, CurveEnd);  \
  template BezierCurve<Dim> Hodograph(const BezierCurve<Dim>&);                              \
  template std::pair<BezierCurve<Dim>, BezierCurve<Dim>> Subdivided(const BezierCurve<Dim>&, \
                                                                    double);                 \
  template BezierCurve<Dim> Elevated(const BezierCurve<Dim>&, int);                          \
  template BezierCurve<Dim> InterpolatingBezierCurve(                                        \
      const Eigen::Matrix<double, Dim, Eigen::Dynamic>&, std::span<const double>);           \
  template BezierCurve<Dim> InterpolatingBezierCurve(                                        \
      const Eigen::Matrix<double, Dim, Eigen::Dynamic>&);                                    \
  template NurbsCurve<Dim> ToNurbs(const BezierCurve<Dim>&, double, double);                 \
  template BezierCurve<Dim> ToBezier(const NurbsCurve<Dim>&);                                \
  template Eigen::MatrixXd Homogeneous(const BezierCurve<Dim>&);                             \
  template BezierCurve<Dim> BezierFromHomogeneous(const Eigen::MatrixXd&, bool)

BATTEN_INSTANTIATE(2);
BATTEN_INSTANTIATE(3);
#undef BATTEN_INSTANTIATE

}  // namespace batten
