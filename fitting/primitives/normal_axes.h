// SPDX-License-Identifier: MIT
// Axes and apexes estimated from the normals of a cloud.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "fitting/primitives/algebraic_fits.h"
#include "fitting/primitives/oriented_points.h"

namespace batten::internal {

// Half angles of cones are not nearer than this to those of a line and of a plane.
inline constexpr double kSharpestCone = 0.02;

// All functions below are linear least squares, reweighted iteratively by Cauchy's loss.

// The directions most nearly perpendicular to all normals, the best in the first column.
Eigen::Matrix3d AcrossNormals(const OrientedPoints& oriented);

// The lines that all normal lines may meet, the best first: those of the rotations c, c̄ at which
// Σ w (c·(p × n) + c̄·n)² is stationary over |c| = 1. A line that the normals leave undetermined, as
// those of a plane do, goes through the centroid, to which a share `towards_centroid` of the sum of
// |c̄|² pulls: the more, the less noise of the normals shifts it. Points are of about unit size.
// [Pottmann & Randrup 1998; Pottmann & Wallner 2001, §6.1] O(n).
std::vector<Axis> LinesMeetingNormals(const OrientedPoints& oriented,
                                      double towards_centroid = 1e-9);

// The cone whose apex lies on all tangent planes and whose axis makes the same angle with the
// directions from the apex to all points.
std::optional<FittedSurface> ConeOfTangentPlanes(const OrientedPoints& oriented,
                                                 const Eigen::Vector3d& near);

}  // namespace batten::internal
