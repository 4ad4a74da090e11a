// SPDX-License-Identifier: MIT
#include "fitting/primitives/circle_fit.h"
#include "geometry/numeric/constants.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace batten::internal {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

// The distance within the circle's plane, positive outside, and how it changes. From the centre it
// is s/κ, s = |(1 + κξ, κη)|, and less 1/κ it is q/(1 + s), q = 2ξ + κ(ξ² + η²): no difference of
// large numbers where κ is small.
struct RadialDistance {
  double value, by_xi, by_eta, by_curvature;

  RadialDistance(double xi, double eta, double kappa) {
    const double square = xi * xi + eta * eta, q = 2 * xi + kappa * square;
    const double s = std::hypot(1 + kappa * xi, kappa * eta);
    constexpr double kAtCenter = 1e-8;
    const double safe = std::max(s, kAtCenter);
    value = q / (1 + s);
    by_xi = (1 + kappa * xi) / safe;
    by_eta = kappa * eta / safe;
    by_curvature = square / (1 + s) - q * (q + kappa * square) / (2 * safe * (1 + s) * (1 + s));
  }
};

// Σ w ρ(d) with its gradient and Gauss–Newton matrix by: shifts along outward and axis, turns about
// outward, tangent and axis, and the curvature. A shift along the tangent is a turn about the
// centre, which moves nothing.
struct NormalForm {
  Matrix6 matrix = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
  double cost = 0;
};

NormalForm FormOf(const FittedCircle& circle,
                  const ShapeData& data,
                  const ShapeLoss& loss,
                  Eigen::Index begin,
                  Eigen::Index end) {
  NormalForm form;
  const Eigen::Vector3d axis = circle.Axis();
  for (Eigen::Index k = begin; k < end; ++k) {
    const Eigen::Vector3d from = data.points.col(k) - circle.point;
    const double xi = from.dot(circle.outward), eta = from.dot(circle.tangent);
    const double zeta = data.plane ? 0 : from.dot(axis);
    const RadialDistance radial(xi, eta, circle.curvature);
    const double distance = std::hypot(radial.value, zeta);
    const double weight = data.weights[k] * LossWeight(loss.loss, distance, loss.scale);
    form.cost += data.weights[k] * LossValue(loss.loss, distance, loss.scale);
    Vector6 row;
    row << -radial.by_xi, 0, radial.by_eta * zeta, -radial.by_xi * zeta,
        radial.by_xi * eta - radial.by_eta * xi, radial.by_curvature;
    form.matrix.noalias() += weight * row * row.transpose();
    form.gradient += weight * radial.value * row;
    if (data.plane) continue;
    Vector6 above;
    above << 0, -1, -eta, xi, 0, 0;
    form.matrix.noalias() += weight * above * above.transpose();
    form.gradient += weight * zeta * above;
  }
  return form;
}

// Sums block by block, so that the result does not depend on the number of threads.
NormalForm FormOf(const FittedCircle& circle,
                  const ShapeData& data,
                  const ShapeLoss& loss,
                  ThreadPool& pool) {
  constexpr Eigen::Index kBlock = 4096;
  const Eigen::Index count = data.points.cols();
  std::vector<NormalForm> parts(static_cast<size_t>((count + kBlock - 1) / kBlock));
  pool.For(count, kBlock, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    parts[static_cast<size_t>(begin / kBlock)] = FormOf(circle, data, loss, begin, end);
  });
  NormalForm form;
  for (const NormalForm& part : parts) {
    form.matrix += part.matrix;
    form.gradient += part.gradient;
    form.cost += part.cost;
  }
  return form;
}

FittedCircle Moved(const FittedCircle& circle, const Vector6& step) {
  const Eigen::Vector3d axis = circle.Axis();
  const Eigen::Vector3d turn = step[2] * circle.outward + step[3] * circle.tangent + step[4] * axis;
  FittedCircle moved = circle;
  moved.point += step[0] * circle.outward + step[1] * axis;
  const double angle = turn.norm();
  if (angle > 0) {
    const Eigen::AngleAxisd rotation(angle, turn / angle);
    moved.outward = (rotation * circle.outward).normalized();
    moved.tangent = rotation * circle.tangent;
    moved.tangent = (moved.tangent - moved.tangent.dot(moved.outward) * moved.outward).normalized();
  }
  moved.curvature += step[5];
  return moved;
}

// The step −(A + λ·diag A)⁻¹ g in units in which the diagonal of A is one.
Vector6 StepOf(const NormalForm& form, double damping) {
  Vector6 unit = form.matrix.diagonal().cwiseSqrt();
  for (double& value : unit) value = value > 0 ? 1 / value : 0;
  Matrix6 scaled = unit.asDiagonal() * form.matrix * unit.asDiagonal();
  constexpr double kSymmetry = 1e-14;  // keeps freedoms without effect solvable under rounding
  scaled.diagonal().array() += damping + kSymmetry;
  for (int i = 0; i < 6; ++i) {
    if (unit[i] == 0) scaled(i, i) = 1;
  }
  const Vector6 right = -unit.cwiseProduct(form.gradient);
  return unit.cwiseProduct(scaled.ldlt().solve(right));
}

// The gradient in the same units: a length, as distances are.
double Slope(const NormalForm& form) {
  double most = 0;
  for (int i = 0; i < 6; ++i) {
    if (form.matrix(i, i) > 0) {
      most = std::max(most, std::abs(form.gradient[i]) / std::sqrt(form.matrix(i, i)));
    }
  }
  return most;
}

// Taubin's circle of points given by two coordinates (2 × m) about their centroid: A(|x|² − z̄) +
// b·x with the least Σ w F² over Σ w |∇F|², z̄ the mean of |x|².
struct AlgebraicCircle {
  Eigen::Vector2d outward;  // at the circle's point nearest to the centroid
  double distance;          // of that point from the centroid, along −outward
  double curvature;
};

AlgebraicCircle TaubinCircle(const Eigen::Matrix2Xd& x, const Eigen::VectorXd& weights) {
  const double mean = x.colwise().squaredNorm().dot(weights) / weights.sum();
  const double root = std::sqrt(mean);
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (Eigen::Index k = 0; k < x.cols(); ++k) {
    const Eigen::Vector3d row((x.col(k).squaredNorm() - mean) / (2 * root), x(0, k), x(1, k));
    moments += weights[k] * row * row.transpose();
  }
  Eigen::Vector3d v = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moments).eigenvectors().col(0);
  if (v[0] < 0) v = -v;
  const double a = v[0] / (2 * root), d = -a * mean;
  const Eigen::Vector2d b = v.tail<2>();
  const double slope = b.norm(), root_of_form = std::hypot(slope, 2 * a * root);
  AlgebraicCircle circle;
  circle.outward = slope > 0 ? (b / slope).eval() : Eigen::Vector2d::UnitX();
  circle.distance = 2 * d / (root_of_form + slope);
  circle.curvature = 2 * a / root_of_form;
  return circle;
}

// Taubin's circle of the points seen along `normal`, in the plane through their centroid.
FittedCircle StartInPlane(const ShapeData& data,
                          const Eigen::Vector3d& centroid,
                          const Eigen::Vector3d& along,
                          const Eigen::Vector3d& normal) {
  const Eigen::Vector3d across = normal.cross(along);
  Eigen::Matrix2Xd x(2, data.points.cols());
  x.row(0) = along.transpose() * (data.points.colwise() - centroid);
  x.row(1) = across.transpose() * (data.points.colwise() - centroid);
  const AlgebraicCircle flat = TaubinCircle(x, data.weights);
  FittedCircle circle;
  circle.outward = flat.outward[0] * along + flat.outward[1] * across;
  circle.tangent = normal.cross(circle.outward);
  circle.point = centroid - flat.distance * circle.outward;
  circle.curvature = flat.curvature;
  return circle;
}

// The direction in which points bend along their longest axis t: the vector c of the least-squares
// parabola a + b t + c t² through their other two coordinates.
Eigen::Vector2d BendOf(const Eigen::Matrix3Xd& local, const Eigen::VectorXd& weights) {
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
  for (Eigen::Index k = 0; k < local.cols(); ++k) {
    const double t = local(0, k);
    const Eigen::Vector3d powers(1, t, t * t);
    moments += weights[k] * powers * powers.transpose();
    right += weights[k] * powers * local.col(k).tail<2>().transpose();
  }
  return moments.ldlt().solve(right).row(2).transpose();
}

}  // namespace

double FittedCircle::Distance(const Eigen::Vector3d& p) const {
  const Eigen::Vector3d from = p - point;
  const RadialDistance radial(from.dot(outward), from.dot(tangent), curvature);
  return std::hypot(radial.value, from.dot(Axis()));
}

double FittedCircle::AngleOf(const Eigen::Vector3d& p) const {
  const Eigen::Vector3d from = p - point;
  return std::atan2(curvature * from.dot(tangent), 1 + curvature * from.dot(outward));
}

Eigen::Vector3d FittedCircle::At(double angle) const {
  const double half = std::sin(angle / 2);
  return point + (std::sin(angle) * tangent - 2 * half * half * outward) / curvature;
}

FittedCircle FittedCircle::Outward() const {
  if (!(curvature < 0)) return *this;
  return {point, -outward, -tangent, -curvature};
}

std::optional<FittedCircle> FittedCircle::Through(const Eigen::Matrix3Xd& sample) {
  const Eigen::Vector3d a = sample.col(0) - sample.col(1), c = sample.col(2) - sample.col(1);
  const Eigen::Vector3d normal = a.cross(c);
  const double area = normal.norm(), sides = a.norm() * c.norm();
  if (!(area > kEpsilon * sides)) return std::nullopt;
  const Eigen::Vector3d inward = (a.squaredNorm() * c - c.squaredNorm() * a).cross(normal);
  FittedCircle circle;
  circle.point = sample.col(1);
  circle.outward = -inward.normalized();
  circle.tangent = normal.normalized().cross(circle.outward).normalized();
  circle.curvature = 2 * area / (sides * (a - c).norm());
  if (!std::isfinite(circle.curvature) || !circle.outward.allFinite()) return std::nullopt;
  return circle;
}

FittedCircle FittedCircle::Start(const ShapeData& data, ThreadPool& pool) {
  const Eigen::Vector3d centroid = data.points * data.weights / data.weights.sum();
  const Eigen::Matrix3Xd from = data.points.colwise() - centroid;
  const Eigen::Matrix3d inertia = from * data.weights.asDiagonal() * from.transpose();
  if (data.plane) {
    return StartInPlane(data, centroid, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertia);
  const Eigen::Matrix3d axes = solver.eigenvectors().rowwise().reverse();
  const FittedCircle full = StartInPlane(data, centroid, axes.col(0), axes.col(2));
  const Eigen::Vector2d bend = BendOf(axes.transpose() * from, data.weights);
  if (!(bend.norm() > 0)) return full;
  const Eigen::Vector3d inward = (axes.rightCols<2>() * bend).normalized();
  const FittedCircle arc =
      StartInPlane(data, centroid, axes.col(0), axes.col(0).cross(inward).normalized());
  return FormOf(arc, data, {}, pool).cost < FormOf(full, data, {}, pool).cost ? arc : full;
}

FittedCircle FittedCircle::Minimised(const ShapeData& data,
                                     const ShapeLoss& loss,
                                     int most_steps,
                                     ThreadPool& pool) const {
  constexpr int kPolishingSteps = 20;
  constexpr double kFirstDamping = 1e-4, kRaise = 8, kLower = 0.2, kMostDamping = 1e12;
  constexpr double kDone = 1e-3;  // of the rounding of distances about one
  FittedCircle circle = *this;
  NormalForm form = FormOf(circle, data, loss, pool);
  double damping = 0;
  for (int step = 0; step < most_steps && form.cost > 0;) {
    if (Slope(form) <= kDone * kEpsilon) break;
    const FittedCircle next = Moved(circle, StepOf(form, damping));
    const NormalForm next_form = FormOf(next, data, loss, pool);
    ++step;
    if (next_form.cost < form.cost) {
      const bool last = damping == 0 && next_form.cost > (1 - 1e-12) * form.cost;
      circle = next;
      form = next_form;
      damping = damping * kLower < kFirstDamping * kLower ? 0 : damping * kLower;
      if (last) break;
    } else {
      if (damping == 0 && next_form.cost <= (1 + 1e-14) * form.cost) break;
      damping = std::max(kFirstDamping, damping * kRaise);
      if (damping > kMostDamping) break;
    }
  }
  // The sum is flat to rounding while its gradient still tells the place.
  for (int step = 0; step < std::min(most_steps, kPolishingSteps); ++step) {
    const FittedCircle next = Moved(circle, StepOf(form, 0));
    const NormalForm next_form = FormOf(next, data, loss, pool);
    const bool better =
        Slope(next_form) < 0.5 * Slope(form) && next_form.cost <= (1 + 16 * kEpsilon) * form.cost;
    if (!better) break;
    circle = next;
    form = next_form;
  }
  return circle;
}

}  // namespace batten::internal
