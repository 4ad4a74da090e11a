// SPDX-License-Identifier: MIT
// Algebraic fits of spheres, and of cylinders, cones and tori about given axes, from the moments of
// points: start values of the orthogonal-distance fit. Used by surface starts only.
#pragma once

#include <Eigen/Core>

#include "fitting/primitives/fitted_surface.h"

namespace batten::internal {

// A line that a shape may turn about.
struct Axis {
  Eigen::Vector3d point, direction;
};

// The sphere of least algebraic distance. It has curvature zero where the points lie in a plane or
// on a line. [Taubin 1991]
FittedSurface AlgebraicSphereFit(const Eigen::Matrix3Xd& points);
FittedSurface AlgebraicCylinderFit(const Eigen::Matrix3Xd& points, const Eigen::Vector3d& axis);

// Cone and torus of revolution about `axis`: the profile is the line, or the algebraic circle,
// fitted to the points in their meridian half-planes.
FittedSurface AlgebraicConeFit(const Eigen::Matrix3Xd& points, const Axis& axis);
FittedSurface AlgebraicTorusFit(const Eigen::Matrix3Xd& points, const Axis& axis);

}  // namespace batten::internal
