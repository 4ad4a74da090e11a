// SPDX-License-Identifier: MIT
#include "fitting/neighbours/local_quadric.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "batten/fitting/statistics.h"
#include "fitting/core/shared_constants.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

constexpr double kMost = 0.8, kNormalAtMost = 1.2816;  // the quantile of |x| at a share
constexpr double kRidge = 1e-12;  // of the mean square: collinear points still have a quadric

double MagnitudeQuantile(const Eigen::VectorXd& values, double fraction) {
  constexpr size_t kOnStack = 64;
  const auto size = static_cast<size_t>(values.size());
  std::array<double, kOnStack> few{};
  std::vector<double> many(size > kOnStack ? size : 0);
  double* magnitudes = size > kOnStack ? many.data() : few.data();
  for (size_t k = 0; k < size; ++k) magnitudes[k] = std::abs(values[static_cast<Eigen::Index>(k)]);
  double* at = magnitudes + static_cast<std::ptrdiff_t>(fraction * static_cast<double>(size));
  std::nth_element(magnitudes, at, magnitudes + size);
  return *at;
}

Eigen::VectorXd CauchyWeights(const Eigen::VectorXd& residuals, double scale) {
  return (1 + (residuals.array() / (2 * scale)).square()).inverse().matrix();
}

double Farthest(const Eigen::Matrix3Xd& differences) {
  return std::sqrt(differences.colwise().squaredNorm().maxCoeff());
}

}  // namespace

LocalPlane WeightedPlane(const Eigen::Matrix3Xd& points, const Eigen::VectorXd& weights) {
  const Eigen::Vector3d centre = points * weights / weights.sum();
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const double x = points(0, k) - centre[0], y = points(1, k) - centre[1];
    const double z = points(2, k) - centre[2], w = weights[k];
    xx += w * x * x;
    xy += w * x * y;
    xz += w * x * z;
    yy += w * y * y;
    yz += w * y * z;
    zz += w * z * z;
  }
  const Eigen::Matrix3d covariance{{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}};
  return {centre, QuickEigenOf3(covariance).vectors.col(0)};
}

AgreedPlane PlaneMostAgreeOn(const Eigen::Matrix3Xd& points) {
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(points.cols());
  AgreedPlane found;
  for (int round = 0; round < kRobustRounds; ++round) {
    found.plane = WeightedPlane(points, weights);
    const Eigen::VectorXd d =
        (points.colwise() - found.plane.centre).transpose() * found.plane.normal;
    found.scale = kMadToSigma * MagnitudeQuantile(d, 0.5);
    if (!(found.scale > 0)) break;
    weights = CauchyWeights(d, found.scale);
  }
  return found;
}

LocalQuadric::LocalQuadric(const Eigen::Matrix3Xd& points, const LocalPlane& plane)
    : LocalQuadric(points, plane, Farthest(points.colwise() - plane.centre)) {}

LocalQuadric::LocalQuadric(const Eigen::Matrix3Xd& points, const LocalPlane& plane, double radius)
    : plane_(plane),
      axis_u_(plane.normal.unitOrthogonal()),
      axis_v_(plane.normal.cross(axis_u_)),
      radius_(radius > 0 ? radius : 1),
      design_(points.cols(), 6) {
  heights_ = (points.colwise() - plane_.centre).transpose() * plane_.normal / radius_;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    design_.row(k) = Monomials(points.col(k)).transpose();
  }
}

LocalQuadric::LocalQuadric(const Eigen::Matrix3Xd& points)
    : LocalQuadric(points, WeightedPlane(points, Eigen::VectorXd::Ones(points.cols()))) {
  Solve(Eigen::VectorXd::Ones(points.cols()));
}

LocalQuadric LocalQuadric::Over(const LocalPlane& plane, const Eigen::Matrix3Xd& points) {
  const Eigen::Matrix3Xd d = points.colwise() - plane.centre;
  LocalQuadric quadric(points, plane, Farthest(d - plane.normal * (plane.normal.transpose() * d)));
  quadric.Solve(Eigen::VectorXd::Ones(points.cols()));
  return quadric;
}

LocalQuadric LocalQuadric::MostAgreeOn(const Eigen::Matrix3Xd& points) {
  // The plane's weights come first: beside an edge they have chosen a side.
  const AgreedPlane agreed = PlaneMostAgreeOn(points);
  LocalQuadric quadric(points, agreed.plane);
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(points.cols());
  if (agreed.scale > 0) {
    weights = CauchyWeights(quadric.radius_ * quadric.heights_, agreed.scale);
  }
  for (int round = 0; round < kRobustRounds; ++round) {
    quadric.Solve(weights);
    const double scale = quadric.robust_scale() / quadric.radius_;
    if (!(scale > 0)) break;
    weights = CauchyWeights(quadric.residuals_, scale);
  }
  return quadric;
}

LocalQuadric::Vector6d LocalQuadric::Monomials(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d d = (point - plane_.centre) / radius_;
  const double x = d.dot(axis_u_), y = d.dot(axis_v_);
  return (Vector6d() << 1, x, y, x * x, x * y, y * y).finished();
}

void LocalQuadric::Solve(const Eigen::VectorXd& weights) {
  Eigen::Matrix<double, 6, 6> normal = design_.transpose() * weights.asDiagonal() * design_;
  normal.diagonal().array() += kRidge * normal.trace();
  const Eigen::LLT<Eigen::Matrix<double, 6, 6>> factor(normal);
  coefficients_ = factor.solve(design_.transpose() * weights.cwiseProduct(heights_));
  covariance_ = factor.solve(Eigen::Matrix<double, 6, 6>::Identity());
  residuals_ = heights_ - design_ * coefficients_;
}

double LocalQuadric::Offset(const Eigen::Vector3d& point) const {
  const double height = (point - plane_.centre).dot(plane_.normal);
  return height - radius_ * Monomials(point).dot(coefficients_);
}

double LocalQuadric::Leverage(const Eigen::Vector3d& point) const {
  const Vector6d m = Monomials(point);
  return m.dot(covariance_ * m);
}

double LocalQuadric::deviation() const {
  const double freedom = std::max(1.0, static_cast<double>(residuals_.size() - 6));
  return radius_ * std::sqrt(residuals_.squaredNorm() / freedom);
}

double LocalQuadric::robust_scale() const {
  return radius_ * kMadToSigma * MagnitudeQuantile(residuals_, 0.5);
}

double LocalQuadric::scale_of_most() const {
  return radius_ * MagnitudeQuantile(residuals_, kMost) / kNormalAtMost;
}

}  // namespace batten::internal
