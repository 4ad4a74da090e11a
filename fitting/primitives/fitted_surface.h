// SPDX-License-Identifier: MIT
// Construction of planes, spheres, cylinders, cones and tori in contact form, and distances from
// them.
#pragma once

#include <Eigen/Core>

#include "batten/geometry/classify_shape.h"
#include "fitting/primitives/surface_contact.h"

namespace batten::internal {

// A shape in contact form with its distance function and its usual parameters.
struct FittedSurface : SurfaceContact {
  // The signed distance of p, positive on the side of the normal at `point`. The profile is that of
  // one half-plane: the other nappe of a cone does not count, nor does the other arc of a torus
  // that cuts its axis. (Otherwise noise between two close sheets would be split between them.)
  double Distance(const Eigen::Vector3d& p) const;

  // The same shape with its contact at the foot point of p; the positive side is kept.
  FittedSurface TouchingNear(const Eigen::Vector3d& p) const;

  // The shape in the data's units, scale · x + shift. Curvatures must not be zero where radii are
  // asked.
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

// Shapes given by their usual parameters, in contact form at a place near p, whatever p's distance.
// Radii are positive; the half-angle is in (0, π/2).
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

}  // namespace batten::internal
