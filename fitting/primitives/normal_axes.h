// SPDX-License-Identifier: MIT
// Axes and apexes estimated from the normals of a cloud. Used by the surface starts only.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "fitting/primitives/algebraic_fits.h"
#include "fitting/primitives/oriented_points.h"

namespace batten::internal {

// All functions below are linear least squares, reweighted iteratively by Cauchy's loss.

// The directions most nearly perpendicular to all normals, the best in the first column.
Eigen::Matrix3d AcrossNormals(const OrientedPoints& oriented);

// The best and the second-best line that meets all normal lines: c·(p × n) + c̄·n is least over |c|
// = 1. [Pottmann & Randrup 1998]
std::vector<Axis> LinesMeetingNormals(const OrientedPoints& oriented);

// The cone whose apex lies on all tangent planes and whose axis makes the same angle with the
// directions from the apex to all points.
std::optional<FittedSurface> ConeOfTangentPlanes(const OrientedPoints& oriented,
                                                 const Eigen::Vector3d& near);

}  // namespace batten::internal
