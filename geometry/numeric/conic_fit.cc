// SPDX-License-Identifier: MIT
#include "geometry/numeric/conic_fit.h"

#include <cmath>

#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

constexpr int kReweightings = 3;

// A frame about the middle of the points, with axes along their principal directions.
PlaneConic Framed(const Eigen::Matrix2Xd& points) {
  PlaneConic conic;
  conic.origin = points.rowwise().mean();
  const Eigen::MatrixXd spread = (points.colwise() - conic.origin).transpose();
  conic.axes = SingularValuesOf(spread).v;
  conic.stretch = (spread * conic.axes).cwiseAbs().colwise().maxCoeff().transpose();
  for (double& s : conic.stretch) {
    if (!(s > 0)) s = 1;
  }
  return conic;
}

Eigen::Matrix2Xd Stretched(const PlaneConic& conic, const Eigen::Matrix2Xd& points) {
  return conic.stretch.cwiseInverse().asDiagonal() * conic.axes.transpose() *
         (points.colwise() - conic.origin);
}

Eigen::Vector2d StretchedGradient(const PlaneConic& conic, const Eigen::Vector2d& X) {
  const auto& c = conic.coefficients;
  return {2 * c[0] * X[0] + c[1] * X[1] + c[3], c[1] * X[0] + 2 * c[2] * X[1] + c[4]};
}

// 1 / |∇F| at every point, of mean one: makes a sum of F² one of squared distances to first order.
Eigen::VectorXd Reweighted(const PlaneConic& conic, const Eigen::Matrix2Xd& stretched) {
  Eigen::VectorXd gradient(stretched.cols());
  for (Eigen::Index k = 0; k < stretched.cols(); ++k) {
    gradient[k] = StretchedGradient(conic, stretched.col(k)).cwiseQuotient(conic.stretch).norm();
  }
  constexpr double kLeast = 1e-3;
  const double floor = kLeast * gradient.mean();
  if (!(floor > 0)) return Eigen::VectorXd::Ones(stretched.cols());
  return gradient.cwiseMax(floor).cwiseInverse() * gradient.mean();
}

// (cos φ·X + sin φ·Y)² and the linear terms, best for the direction φ; φ follows from the term
// 2·(cos φ·X + sin φ·Y)·(−sin φ·X + cos φ·Y), whose coefficient is a small turn. Gauss–Newton.
double TurnedParabola(PlaneConic& conic,
                      const Eigen::Matrix2Xd& stretched,
                      const Eigen::VectorXd& weights,
                      double angle,
                      bool turn) {
  const double c = std::cos(angle), s = std::sin(angle);
  const Eigen::ArrayXd X = stretched.row(0), Y = stretched.row(1);
  const Eigen::ArrayXd across = c * X + s * Y, along = c * Y - s * X;
  Eigen::MatrixXd design(stretched.cols(), turn ? 5 : 4);
  design.col(0) = across.square();
  design.col(1) = X;
  design.col(2) = Y;
  design.col(3).setOnes();
  if (turn) design.col(4) = 2 * across * along;
  const Eigen::VectorXd v = NullVector(weights.asDiagonal() * design);
  conic.coefficients << v[0] * c * c, 2 * v[0] * c * s, v[0] * s * s, v[1], v[2], v[3];
  if (!turn || v[0] == 0) return angle;
  return angle + std::atan(v[4] / v[0]);
}

}  // namespace

Eigen::VectorXd NullVector(const Eigen::MatrixXd& design) {
  return SingularValuesOf(design).v.rightCols(1);
}

// The root of F + |∇F| s + H s² nearest to zero, H the second-order term along the gradient.
double PlaneConic::DistanceBound(const Eigen::Vector2d& point) const {
  const Eigen::Vector2d X = (axes.transpose() * (point - origin)).cwiseQuotient(stretch);
  const auto& c = coefficients;
  const double F = c[0] * X[0] * X[0] + c[1] * X[0] * X[1] + c[2] * X[1] * X[1] + c[3] * X[0] +
                   c[4] * X[1] + c[5];
  if (F == 0) return 0;
  const Eigen::Vector2d gradient = StretchedGradient(*this, X).cwiseQuotient(stretch);
  const double slope = gradient.norm();
  if (!(slope > 0)) return std::numeric_limits<double>::infinity();
  const Eigen::Vector2d d = (gradient / slope).cwiseQuotient(stretch);
  const double H = c[0] * d[0] * d[0] + c[1] * d[0] * d[1] + c[2] * d[1] * d[1];
  const double root = slope * slope - 4 * H * F;
  if (!(root >= 0)) return std::numeric_limits<double>::infinity();
  return 2 * std::abs(F) / (slope + std::sqrt(root));
}

Eigen::Matrix2d PlaneConic::Quadratic() const {
  const double xy = coefficients[1] / (2 * stretch[0] * stretch[1]);
  return Eigen::Matrix2d{{coefficients[0] / (stretch[0] * stretch[0]), xy},
                         {xy, coefficients[2] / (stretch[1] * stretch[1])}};
}

Eigen::Vector2d PlaneConic::Linear() const {
  return {coefficients[3] / stretch[0], coefficients[4] / stretch[1]};
}

PlaneConic FitCircle(const Eigen::Matrix2Xd& points) {
  PlaneConic conic = Framed(points);
  const Eigen::Matrix2Xd X = Stretched(conic, points);
  const Eigen::Vector2d squares = (conic.stretch / conic.stretch.maxCoeff()).cwiseAbs2();
  Eigen::MatrixXd design(points.cols(), 4);
  design.col(0) = X.cwiseAbs2().transpose() * squares;
  design.middleCols(1, 2) = X.transpose();
  design.col(3).setOnes();
  const Eigen::VectorXd v = NullVector(design);
  conic.coefficients << v[0] * squares[0], 0, v[0] * squares[1], v[1], v[2], v[3];
  return conic;
}

PlaneConic FitConic(const Eigen::Matrix2Xd& points) {
  PlaneConic conic = Framed(points);
  const Eigen::Matrix2Xd stretched = Stretched(conic, points);
  const Eigen::ArrayXd X = stretched.row(0), Y = stretched.row(1);
  Eigen::MatrixXd design(points.cols(), 6);
  design << (X * X).matrix(), (X * Y).matrix(), (Y * Y).matrix(), X.matrix(), Y.matrix(),
      Eigen::VectorXd::Ones(points.cols());
  conic.coefficients = NullVector(design);
  for (int k = 1; k < kReweightings; ++k) {
    conic.coefficients = NullVector(Reweighted(conic, stretched).asDiagonal() * design);
  }
  return conic;
}

// From the conic whose weaker quadratic term is left out.
PlaneConic FitParabola(const Eigen::Matrix2Xd& points) {
  PlaneConic conic = FitConic(points);
  const Eigen::Matrix2Xd stretched = Stretched(conic, points);
  const auto& c = conic.coefficients;
  double angle = std::atan2(c[1], c[0] - c[2]) / 2;  // of an eigenvector of the quadratic part
  const double trace = c[0] + c[2], difference = std::hypot(c[0] - c[2], c[1]);
  if (std::abs(trace + difference) < std::abs(trace - difference)) angle += std::acos(0.0);
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(points.cols());
  constexpr int kTurns = 8;
  for (int k = 0; k < kTurns; ++k) {
    const double next = TurnedParabola(conic, stretched, weights, angle, true);
    weights = Reweighted(conic, stretched);
    if (next == angle) break;
    angle = next;
  }
  TurnedParabola(conic, stretched, weights, angle, false);
  return conic;
}

std::optional<PlaneCircle> CircleOf(const PlaneConic& conic) {
  const double a = conic.Quadratic()(0, 0);
  const Eigen::Vector2d center = conic.Linear() / (-2 * a);
  const double squared = center.squaredNorm() - conic.Constant() / a;
  if (!center.allFinite() || !(squared > 0) || !std::isfinite(squared)) return std::nullopt;
  return PlaneCircle{conic.Back(center), std::sqrt(squared)};
}

}  // namespace batten::internal
