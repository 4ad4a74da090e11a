// SPDX-License-Identifier: MIT
#include "fitting/primitives/algebraic_fits.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

// The surface in contact form at (distance, height) of the meridian, its normal turned by `slope`.
FittedSurface Turned(SurfaceKind kind,
                     const Axis& axis,
                     const Eigen::Vector2d& at,
                     double slope,
                     const Eigen::Vector3d& near) {
  constexpr double kLeast = 1e-3;
  Eigen::Vector3d outward = near - axis.point;
  outward -= outward.dot(axis.direction) * axis.direction;
  outward = outward.norm() > 0 ? outward.normalized() : axis.direction.unitOrthogonal();
  return AboutAxis(kind,
                   axis.point + at[1] * axis.direction,
                   axis.direction,
                   outward,
                   std::max(at[0], kLeast),
                   slope);
}

}  // namespace

Eigen::Matrix2Xd MeridianOf(const Eigen::Matrix3Xd& points, const Axis& axis) {
  Eigen::Matrix2Xd meridian(2, points.cols());
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const Eigen::Vector3d from = points.col(k) - axis.point;
    const double height = from.dot(axis.direction);
    meridian.col(k) << (from - height * axis.direction).norm(), height;
  }
  return meridian;
}

FittedSurface AlgebraicSphereFit(const Eigen::Matrix3Xd& points) {
  const Eigen::Vector3d centroid = points.rowwise().mean();
  const AlgebraicRound<3> round(points.colwise() - centroid);
  FittedSurface shape = PlaneAt(centroid - round.distance * round.outward, round.outward);
  shape.kind = SurfaceKind::kSphere;
  shape.curvature = round.curvature;
  return shape;
}

FittedSurface AlgebraicCylinderFit(const Eigen::Matrix3Xd& points, const Eigen::Vector3d& axis) {
  const Eigen::Vector3d centroid = points.rowwise().mean();
  Eigen::Matrix<double, 3, 2> across;
  across.col(0) = axis.unitOrthogonal();
  across.col(1) = axis.cross(across.col(0));
  const AlgebraicRound<2> round(across.transpose() * (points.colwise() - centroid));
  FittedSurface shape;
  shape.kind = SurfaceKind::kCylinder;
  shape.normal = across * round.outward;
  shape.along = axis;
  shape.point = centroid - round.distance * shape.normal;
  shape.axis_curvature = round.curvature;
  return shape;
}

FittedSurface AlgebraicConeFit(const Eigen::Matrix3Xd& points, const Axis& axis) {
  const Eigen::Matrix2Xd meridian = MeridianOf(points, axis);
  const Eigen::Vector2d mean = meridian.rowwise().mean();
  const Eigen::Matrix2Xd from = meridian.colwise() - mean;
  const Eigen::Vector2d normal = EigenOf(from * from.transpose()).vectors.col(0);
  return Turned(SurfaceKind::kCone, axis, mean, std::atan2(normal[1], normal[0]), points.col(0));
}

FittedSurface AlgebraicTorusFit(const Eigen::Matrix3Xd& points, const Axis& axis) {
  const Eigen::Matrix2Xd meridian = MeridianOf(points, axis);
  const Eigen::Vector2d mean = meridian.rowwise().mean();
  const AlgebraicRound<2> round(meridian.colwise() - mean);
  FittedSurface shape = Turned(SurfaceKind::kTorus,
                               axis,
                               mean - round.distance * round.outward,
                               std::atan2(round.outward[1], round.outward[0]),
                               points.col(0));
  shape.curvature = round.curvature;
  return shape;
}

}  // namespace batten::internal
