// SPDX-License-Identifier: MIT
// Spheres, and cylinders, cones and tori about given axes, by the moments of points: starts for the
// search for the nearest. Used by that only.
#pragma once

#include <Eigen/Core>

#include "fitting/primitives/fitted_surface.h"

namespace batten::internal {

// A line that a shape may turn about.
struct Axis {
  Eigen::Vector3d point, direction;
};

// By algebraic squares; of points in a plane or on a line across, of curvature zero. [Taubin 1991]
FittedSurface AlgebraicSphereFit(const Eigen::Matrix3Xd& points);
FittedSurface AlgebraicCylinderFit(const Eigen::Matrix3Xd& points, const Eigen::Vector3d& axis);

// The line and the algebraic circle through the points in their meridian half-planes.
FittedSurface AlgebraicConeFit(const Eigen::Matrix3Xd& points, const Axis& axis);
FittedSurface AlgebraicTorusFit(const Eigen::Matrix3Xd& points, const Axis& axis);

}  // namespace batten::internal
