// SPDX-License-Identifier: MIT
#include "fitting/primitives/circle_fit.h"

#include <cmath>

#include "fitting/primitives/algebraic_fits.h"
#include "fitting/primitives/shape_descent.h"
#include "fitting/primitives/surface_distance.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

// Σ w ρ(d) with its gradient and Gauss–Newton matrix by: shifts along outward and axis, turns about
// outward, tangent and axis, and the curvature. A shift along the tangent is a turn about the
// centre, which moves nothing.
using NormalForm = ShapeForm<6>;

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
    const CircleDistance radial(xi, eta, circle.curvature);
    const double distance = std::hypot(radial.value, zeta);
    const double weight = data.weights[k] * LossWeight(loss.loss, distance, loss.scale);
    form.cost += data.weights[k] * LossValue(loss.loss, distance, loss.scale);
    Vector6 row;
    row << -radial.by_x, 0, radial.by_y * zeta, -radial.by_x * zeta,
        radial.by_x * eta - radial.by_y * xi, radial.by_curvature;
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

NormalForm FormOf(const FittedCircle& circle,
                  const ShapeData& data,
                  const ShapeLoss& loss,
                  ThreadPool& pool) {
  return SumOfBlocks<kSumBlock>(
      data.points.cols(),
      [&](Eigen::Index begin, Eigen::Index end) { return FormOf(circle, data, loss, begin, end); },
      pool);
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

// Taubin's circle of the points seen along `normal`, in the plane through their centroid.
FittedCircle StartInPlane(const ShapeData& data,
                          const Eigen::Vector3d& centroid,
                          const Eigen::Vector3d& along,
                          const Eigen::Vector3d& normal) {
  const Eigen::Vector3d across = normal.cross(along);
  Eigen::Matrix2Xd x(2, data.points.cols());
  x.row(0) = along.transpose() * (data.points.colwise() - centroid);
  x.row(1) = across.transpose() * (data.points.colwise() - centroid);
  const AlgebraicRound<2> flat(x, data.weights);
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
  return SymmetricSolution(moments, right).row(2).transpose();
}

}  // namespace

double FittedCircle::Distance(const Eigen::Vector3d& p) const {
  const Eigen::Vector3d from = p - point;
  const CircleDistance radial(from.dot(outward), from.dot(tangent), curvature);
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
  const Eigen::Matrix3d axes = EigenOf3(inertia).vectors.rowwise().reverse();
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
  return ShapeDescent<FittedCircle, 6>::Run(
             *this,
             [&](const FittedCircle& circle) { return FormOf(circle, data, loss, pool); },
             [](const FittedCircle& circle, const Vector6& step) { return Moved(circle, step); },
             6,
             data.weights.sum(),
             HUGE_VAL,
             most_steps)
      .shape;
}

}  // namespace batten::internal
