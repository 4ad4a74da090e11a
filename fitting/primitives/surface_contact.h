// SPDX-License-Identifier: MIT
// Planes, spheres, cylinders, cones and tori in contact form: a point, its normal and the
// curvatures there.
#pragma once

#include <Eigen/Core>
#include <array>

namespace batten::internal {

// The kinds in the order of their degrees of freedom: 3, 4, 5, 6, 7.
enum class SurfaceKind { kPlane, kSphere, kCylinder, kCone, kTorus };

inline constexpr std::array kSurfaceKinds{SurfaceKind::kPlane,
                                          SurfaceKind::kSphere,
                                          SurfaceKind::kCylinder,
                                          SurfaceKind::kCone,
                                          SurfaceKind::kTorus};

// "plane", "sphere", …
const char* Name(SurfaceKind kind);
constexpr int FreedomsOf(SurfaceKind kind) { return 3 + static_cast<int>(kind); }

// A shape in contact form, given by one of its points. With curvatures in place of radii, and
// lengths from `point` in place of those from centres, nearly flat pieces lose no digits: a plane
// is the sphere of curvature zero, a cylinder the cone of slope zero. [Lukács, Martin & Marshall
// 1998] Cylinder, cone and torus turn a line or circle, the profile, about an axis. At `point` the
// profile runs along `along`. The axis has the direction sin(slope)·normal + cos(slope)·along and
// lies at point − Outward()/axis_curvature; the profile's centre is at point − normal/curvature.
// Curvatures may be negative: the shape then bends towards the normal.
struct SurfaceContact {
  SurfaceKind kind = SurfaceKind::kPlane;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ(), along = Eigen::Vector3d::UnitX();
  double curvature = 0;       // of a sphere, and of a torus' profile; else 0
  double axis_curvature = 0;  // one over the distance of `point` from the axis
  double slope = 0;           // of cone and torus; else 0

  Eigen::Vector3d Axis() const;
  Eigen::Vector3d Outward() const;  // across the axis, away from it where axis_curvature > 0
  Eigen::Vector3d Across() const { return along.cross(normal); }
  // The axis or, of a plane, the normal.
  Eigen::Vector3d Direction() const { return kind == SurfaceKind::kPlane ? normal : Axis(); }
  // The place of the axis beside `point`.
  Eigen::Vector3d OnAxis() const { return point - Outward() / axis_curvature; }
  // The centre of a sphere, or of a torus' profile.
  Eigen::Vector3d Center() const { return point - normal / curvature; }
  double PipeRadius() const;  // of a sphere, of a cylinder or of a torus' profile
  // Positive where the normal looks away from the axis or centre, or is a plane's.
  double NaturalSide() const;
};

}  // namespace batten::internal
