// SPDX-License-Identifier: MIT
#include "geometry/shapes/revolved_circle.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace batten::internal {
namespace {

// Where a point lies in its meridian half-plane, and how that changes.
struct Meridian {
  double over, height;       // ξ
  Eigen::Vector3d outward;   // ∂over/∂p
  double by_axis_curvature;  // ∂over/∂axis_curvature
};

// With x across the axis, the distance from the axis is s/τ, s = |τ x + outward|, and less 1/τ it
// is q/(1 + s), q = τ |x|² + 2 x·outward.
Meridian MeridianOf(const RevolvedCircle& shape, const Eigen::Vector3d& p) {
  const double tau = shape.axis_curvature;
  const Eigen::Vector3d from = p - shape.point;
  Meridian m;
  m.height = from.dot(shape.axis);
  const Eigen::Vector3d x = from - m.height * shape.axis;
  const double square = x.squaredNorm(), q = tau * square + 2 * x.dot(shape.outward);
  const double s = (tau * x + shape.outward).norm();
  m.over = q / (1 + s);
  constexpr double kOnAxis = 1e-8;
  const double safe = std::max(s, kOnAxis);
  m.outward = (tau * x + shape.outward) / safe;
  m.by_axis_curvature = square / (1 + s) - q * (q + tau * square) / (2 * safe * (1 + s) * (1 + s));
  return m;
}

// The same place on the other side of the axis.
Meridian Mirrored(const Meridian& m, double axis_curvature) {
  return {-m.over - 2 / axis_curvature,
          m.height,
          -m.outward,
          -m.by_axis_curvature + 2 / (axis_curvature * axis_curvature)};
}

struct CircleProfile {
  double distance;
  Eigen::Vector2d gradient;  // by ξ
  double by_curvature, by_slope;
};

// In the same way |ξ − ν/κ| − 1/κ = q/(1 + s), s = |κ ξ − ν|, q = κ |ξ|² − 2 ξ·ν.
CircleProfile ProfileOf(const RevolvedCircle& shape, const Eigen::Vector2d& xi) {
  const double kappa = shape.curvature;
  const Eigen::Vector2d nu(std::cos(shape.slope), std::sin(shape.slope)), turned(-nu[1], nu[0]);
  const double square = xi.squaredNorm(), q = kappa * square - 2 * xi.dot(nu);
  const double s = (kappa * xi - nu).norm();
  constexpr double kAtCenter = 1e-8;
  const double safe = std::max(s, kAtCenter);
  return {q / (1 + s),
          (kappa * xi - nu) / safe,
          square / (1 + s) - q * (q + kappa * square) / (2 * safe * (1 + s) * (1 + s)),
          -xi.dot(turned) / safe};
}

struct Place {
  Meridian meridian;
  CircleProfile profile;
};

// On the side of the axis where the profile is nearer.
Place PlaceOf(const RevolvedCircle& shape, const Eigen::Vector3d& p) {
  const Meridian m = MeridianOf(shape, p);
  const Place here{m, ProfileOf(shape, {m.over, m.height})};
  if (!(shape.axis_curvature > 0)) return here;
  const Meridian other = Mirrored(m, shape.axis_curvature);
  const Place there{other, ProfileOf(shape, {other.over, other.height})};
  return std::abs(there.profile.distance) < std::abs(here.profile.distance) ? there : here;
}

constexpr int kFreedoms = 9;

// Distances, and their derivatives by a shift, a turn about `point`, axis_curvature, slope and
// curvature.
void Linearize(const RevolvedCircle& shape,
               const Eigen::Matrix3Xd& points,
               Eigen::Matrix<double, Eigen::Dynamic, kFreedoms>& jacobian,
               Eigen::VectorXd& distances) {
  jacobian.resize(points.cols(), kFreedoms);
  distances.resize(points.cols());
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const auto [m, profile] = PlaceOf(shape, points.col(k));
    const Eigen::Vector3d gradient =
        profile.gradient[0] * m.outward + profile.gradient[1] * shape.axis;
    const Eigen::Vector3d from = points.col(k) - shape.point;
    jacobian.row(k) << -gradient.transpose(), -from.cross(gradient).transpose(),
        profile.gradient[0] * m.by_axis_curvature, profile.by_slope, profile.by_curvature;
    distances[k] = profile.distance;
  }
}

RevolvedCircle Moved(RevolvedCircle shape, const Eigen::Matrix<double, kFreedoms, 1>& step) {
  shape.point += step.head<3>();
  const Eigen::Vector3d turn = step.segment<3>(3);
  const double angle = turn.norm();
  if (angle > 0) {
    const Eigen::AngleAxisd rotation(angle, turn / angle);
    shape.axis = (rotation * shape.axis).normalized();
    shape.outward = rotation * shape.outward;
  }
  shape.outward = (shape.outward - shape.outward.dot(shape.axis) * shape.axis).normalized();
  shape.axis_curvature += step[6];
  if (shape.axis_curvature < 0) {
    shape.axis_curvature = -shape.axis_curvature;
    shape.outward = -shape.outward;
    shape.slope = std::acos(-1.0) - shape.slope;
  }
  shape.slope += step[7];
  shape.curvature += step[8];
  return shape;
}

double SquaredSum(const RevolvedCircle& shape, const Eigen::Matrix3Xd& points) {
  double sum = 0;
  for (const auto& p : points.colwise()) {
    const double d = shape.Distance(p);
    sum += d * d;
  }
  return sum;
}

}  // namespace

double RevolvedCircle::Distance(const Eigen::Vector3d& p) const {
  return PlaceOf(*this, p).profile.distance;
}

RevolvedCircle FitRevolved(RevolvedKind kind,
                           RevolvedCircle shape,
                           const Eigen::Matrix3Xd& points) {
  constexpr int kSteps = 30, kHalvings = 6;
  constexpr double kSymmetry = 1e-13;  // freedoms that move nothing are rounding
  Eigen::Matrix<double, Eigen::Dynamic, kFreedoms> jacobian;
  Eigen::VectorXd distances;
  double sum = SquaredSum(shape, points);
  for (int k = 0; k < kSteps && sum > 0; ++k) {
    Linearize(shape, points, jacobian, distances);
    if (kind != RevolvedKind::kTorus) jacobian.col(8).setZero();
    if (kind == RevolvedKind::kCylinder) jacobian.col(7).setZero();
    if (!jacobian.allFinite()) break;
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(jacobian);
    const Eigen::MatrixXd r = qr.matrixQR().topRows<kFreedoms>().triangularView<Eigen::Upper>();
    const Eigen::VectorXd right = (qr.householderQ().transpose() * distances).head(kFreedoms);
    Eigen::JacobiSVD<Eigen::MatrixXd> svd(r, Eigen::ComputeThinU | Eigen::ComputeThinV);
    svd.setThreshold(kSymmetry);
    Eigen::Matrix<double, kFreedoms, 1> step = -svd.solve(right);
    double next_sum = sum;
    RevolvedCircle next = shape;
    for (int halving = 0; halving < kHalvings; ++halving, step /= 2) {
      next = Moved(shape, step);
      next_sum = SquaredSum(next, points);
      if (next_sum < sum) break;
    }
    if (!(next_sum < sum)) break;
    shape = next;
    sum = next_sum;
  }
  return shape;
}

}  // namespace batten::internal
