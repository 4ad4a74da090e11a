// SPDX-License-Identifier: MIT
// Planes, spheres, cylinders, cones and tori by where they touch a point and how they bend there.
#pragma once

#include <Eigen/Core>
#include <array>

#include "batten/geometry/classify_shape.h"

namespace batten {

// In the order of their freedoms: 3, 4, 5, 6, 7.
enum class SurfaceKind { kPlane, kSphere, kCylinder, kCone, kTorus };

inline constexpr std::array kSurfaceKinds{SurfaceKind::kPlane,
                                          SurfaceKind::kSphere,
                                          SurfaceKind::kCylinder,
                                          SurfaceKind::kCone,
                                          SurfaceKind::kTorus};

// "plane", "sphere", …
const char* Name(SurfaceKind kind);
constexpr int FreedomsOf(SurfaceKind kind) { return 3 + static_cast<int>(kind); }

// A shape by one of its points. With curvatures in place of radii, and lengths from `point` in
// place of those from centres, nearly flat pieces lose no digits: a plane is the sphere of
// curvature zero, a cylinder the cone of slope zero. [Lukács, Martin & Marshall 1998]
// Cylinder, cone and torus turn a line or circle, the profile, about an axis. At `point` the
// profile runs along `along`. The axis has the direction sin(slope)·normal + cos(slope)·along and
// lies at point − Outward()/axis_curvature; the profile's centre is at point − normal/curvature.
// Curvatures may be negative: the shape then bends towards the normal.
struct FittedSurface {
  SurfaceKind kind = SurfaceKind::kPlane;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ(), along = Eigen::Vector3d::UnitX();
  double curvature = 0;       // of a sphere, and of a torus' profile; else 0
  double axis_curvature = 0;  // one over the distance of `point` from the axis
  double slope = 0;           // of cone and torus; else 0

  Eigen::Vector3d Axis() const;
  Eigen::Vector3d Outward() const;  // across the axis, away from it where axis_curvature > 0
  Eigen::Vector3d Across() const { return along.cross(normal); }

  // Signed, positive on the side of the normal at `point`. The profile is that of one half-plane:
  // the other nappe of a cone does not count, nor does the other arc of a torus that cuts its axis.
  // (Two sheets that are close would take noise between them for their own.)
  double Distance(const Eigen::Vector3d& p) const;

  // The same shape, touching at the foot of p; the side that is positive stays.
  FittedSurface TouchingNear(const Eigen::Vector3d& p) const;

  // In the data's own units: scale · x + shift. Curvatures must not be zero where radii are asked.
  SurfaceShape Shape(double scale, const Eigen::Vector3d& shift) const;
};

// A cylinder, cone or torus by its axis: it touches at the place `radius` outward from `foot`, its
// normal turned from there by `slope` towards the axis' direction.
FittedSurface AboutAxis(SurfaceKind kind,
                        const Eigen::Vector3d& foot,
                        const Eigen::Vector3d& axis,
                        const Eigen::Vector3d& outward,
                        double radius,
                        double slope);

// The shapes that touch near a point p, at any distance from it. Radii are positive; the half-angle
// is in (0, π/2).
FittedSurface PlaneAt(const Eigen::Vector3d& point, const Eigen::Vector3d& normal);
FittedSurface SphereNear(const Eigen::Vector3d& p, const Eigen::Vector3d& center, double radius);
FittedSurface CylinderNear(const Eigen::Vector3d& p,
                           const Eigen::Vector3d& on_axis,
                           const Eigen::Vector3d& axis,
                           double radius);
FittedSurface ConeNear(const Eigen::Vector3d& p,
                       const Eigen::Vector3d& apex,
                       const Eigen::Vector3d& axis,
                       double half_angle);
FittedSurface TorusNear(const Eigen::Vector3d& p,
                        const Eigen::Vector3d& center,
                        const Eigen::Vector3d& axis,
                        double major_radius,
                        double minor_radius);

}  // namespace batten
