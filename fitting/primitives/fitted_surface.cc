// SPDX-License-Identifier: MIT
#include "fitting/primitives/fitted_surface.h"

#include <Eigen/Geometry>
#include <cmath>

#include "fitting/core/rounding.h"
#include "fitting/primitives/surface_distance.h"

namespace batten::internal {
namespace {

Eigen::Vector3d PartAcross(const Eigen::Vector3d& v, const Eigen::Vector3d& unit) {
  return v - v.dot(unit) * unit;
}

// The unit direction of v's part across `unit`; any such direction where v has no part across it.
Eigen::Vector3d DirectionAcross(const Eigen::Vector3d& v, const Eigen::Vector3d& unit) {
  const Eigen::Vector3d part = PartAcross(v, unit);
  const double length = part.norm();
  if (!(length > kRelativeRounding * v.norm())) return unit.unitOrthogonal();
  return PartAcross(part / length, unit).normalized();
}

FittedSurface SphereTouchingNear(FittedSurface shape, const Eigen::Vector3d& p) {
  const Eigen::Vector3d from = p - shape.point;
  const double distance = shape.Distance(p);
  const Eigen::Vector3d radial = shape.normal + shape.curvature * from;
  if (!(radial.norm() > 0)) return shape;  // at the centre
  const Eigen::Vector3d normal = radial.normalized();
  shape.point = p - distance * normal;
  shape.along = DirectionAcross(shape.along, normal);
  shape.normal = normal;
  return shape;
}

FittedSurface RevolvedTouchingNear(FittedSurface shape, const Eigen::Vector3d& p) {
  const Eigen::Vector3d from = p - shape.point, axis = shape.Axis(), outward = shape.Outward();
  const double tau = shape.axis_curvature, kappa = shape.curvature;
  const double x = from.dot(outward), c = from.dot(shape.Across()), height = from.dot(axis);
  const CircleDistance round(x, c, tau);
  const Eigen::Vector3d new_outward =
      DirectionAcross((1 + tau * x) * outward + tau * c * shape.Across(), axis);
  const double sine = std::sin(shape.slope), cosine = std::cos(shape.slope);
  double n = cosine * round.value + sine * height, t = cosine * height - sine * round.value;
  const CircleDistance profile(n, t, kappa);
  n -= profile.value * profile.by_x;
  t -= profile.value * profile.by_y;
  const double over = cosine * n - sine * t, new_height = sine * n + cosine * t;
  // Outward at the old point, moved to the new place: over is measured from the same distance.
  FittedSurface moved = shape;
  moved.point =
      p - height * axis - round.value * new_outward + over * new_outward + new_height * axis;
  moved.axis_curvature = tau / (1 + tau * over);
  moved.slope = shape.slope + std::atan2(kappa * t, 1 + kappa * n);
  moved.normal = std::cos(moved.slope) * new_outward + std::sin(moved.slope) * axis;
  moved.along = std::cos(moved.slope) * axis - std::sin(moved.slope) * new_outward;
  return std::isfinite(moved.axis_curvature) ? moved : shape;
}

ConeShape ConeOf(const FittedSurface& s, double scale, const Eigen::Vector3d& shift) {
  const double sine = std::sin(s.slope), cosine = std::cos(s.slope);
  const double up = cosine / (sine * s.axis_curvature);  // from beside the point to the apex
  const Eigen::Vector3d axis = s.Axis();
  const Eigen::Vector3d apex = s.OnAxis() + up * axis;
  return {shift + scale * apex,
          up > 0 ? Eigen::Vector3d(-axis) : axis,
          std::atan2(std::abs(sine), std::abs(cosine))};
}

TorusShape TorusOf(const FittedSurface& s, double scale, const Eigen::Vector3d& shift) {
  const double radius = 1 / s.curvature;
  const double over = 1 / s.axis_curvature - radius * std::cos(s.slope);
  const Eigen::Vector3d center = s.OnAxis() - radius * std::sin(s.slope) * s.Axis();
  return {shift + scale * center, s.Axis(), scale * std::abs(over), scale * std::abs(radius)};
}

}  // namespace

double FittedSurface::Distance(const Eigen::Vector3d& p) const {
  return WithKind(kind, [&]<SurfaceKind kKind>() {
    typename SurfaceDistance<kKind>::Row row;
    return SurfaceDistance<kKind>(*this)(p, row);
  });
}

FittedSurface FittedSurface::TouchingNear(const Eigen::Vector3d& p) const {
  if (kind == SurfaceKind::kPlane) {
    FittedSurface moved = *this;
    moved.point = p - normal.dot(p - point) * normal;
    return moved;
  }
  return kind == SurfaceKind::kSphere ? SphereTouchingNear(*this, p)
                                      : RevolvedTouchingNear(*this, p);
}

SurfaceShape FittedSurface::Shape(double scale, const Eigen::Vector3d& shift) const {
  switch (kind) {
    case SurfaceKind::kPlane:
      return PlaneShape{shift + scale * point, normal};
    case SurfaceKind::kSphere:
      return SphereShape{shift + scale * (point - normal / curvature), scale / std::abs(curvature)};
    case SurfaceKind::kCylinder:
      return CylinderShape{shift + scale * (point - normal / axis_curvature),
                           along,
                           scale / std::abs(axis_curvature)};
    case SurfaceKind::kCone:
      return ConeOf(*this, scale, shift);
    case SurfaceKind::kTorus:
      break;
  }
  return TorusOf(*this, scale, shift);
}

FittedSurface AboutAxis(SurfaceKind kind,
                        const Eigen::Vector3d& foot,
                        const Eigen::Vector3d& axis,
                        const Eigen::Vector3d& outward,
                        double radius,
                        double slope) {
  FittedSurface shape;
  shape.kind = kind;
  shape.point = foot + radius * outward;
  shape.normal = std::cos(slope) * outward + std::sin(slope) * axis;
  shape.along = std::cos(slope) * axis - std::sin(slope) * outward;
  shape.axis_curvature = 1 / radius;
  shape.slope = slope;
  return shape;
}

FittedSurface PlaneAt(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
  FittedSurface shape;
  shape.point = point;
  shape.normal = normal.normalized();
  shape.along = shape.normal.unitOrthogonal();
  return shape;
}

FittedSurface SphereNear(const Eigen::Vector3d& p, const Eigen::Vector3d& center, double radius) {
  FittedSurface shape;
  shape.kind = SurfaceKind::kSphere;
  const Eigen::Vector3d from = p - center;
  shape.normal = from.norm() > 0 ? from.normalized() : Eigen::Vector3d::UnitZ().eval();
  shape.point = center + radius * shape.normal;
  shape.along = shape.normal.unitOrthogonal();
  shape.curvature = 1 / radius;
  return shape;
}

FittedSurface CylinderNear(const Eigen::Vector3d& p,
                           const Eigen::Vector3d& on_axis,
                           const Eigen::Vector3d& axis,
                           double radius) {
  const Eigen::Vector3d from = p - on_axis;
  return AboutAxis(SurfaceKind::kCylinder,
                   on_axis + from.dot(axis) * axis,
                   axis,
                   DirectionAcross(from, axis),
                   radius,
                   0);
}

FittedSurface ConeNear(const Eigen::Vector3d& p,
                       const Eigen::Vector3d& apex,
                       const Eigen::Vector3d& axis,
                       double half_angle) {
  const Eigen::Vector3d from = p - apex, outward = DirectionAcross(from, axis);
  const double s = std::sin(half_angle), c = std::cos(half_angle);
  const double least = 1e-6 * from.norm();  // along the profile: never the apex itself
  const double reach = std::max(from.dot(c * axis + s * outward), least);
  return AboutAxis(SurfaceKind::kCone,
                   apex + reach * c * axis,
                   axis,
                   outward,
                   std::max(reach * s, least * s),
                   -half_angle);
}

FittedSurface TorusNear(const Eigen::Vector3d& p,
                        const Eigen::Vector3d& center,
                        const Eigen::Vector3d& axis,
                        double major_radius,
                        double minor_radius) {
  const Eigen::Vector3d from = p - center, outward = DirectionAcross(from, axis);
  const double height = from.dot(axis), over = from.dot(outward) - major_radius;
  const double slope = std::atan2(height, over), sine = std::sin(slope);
  // A spindle torus keeps its outer arc only.
  const double radius =
      std::max(major_radius + minor_radius * std::cos(slope), 1e-3 * (major_radius + minor_radius));
  FittedSurface shape = AboutAxis(
      SurfaceKind::kTorus, center + minor_radius * sine * axis, axis, outward, radius, slope);
  shape.curvature = 1 / minor_radius;
  return shape;
}

}  // namespace batten::internal
