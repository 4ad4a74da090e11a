// SPDX-License-Identifier: MIT
// What the normals of a cloud say about axes and apexes. Used by the starts of surfaces only.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "fitting/primitives/algebraic_fits.h"
#include "fitting/primitives/oriented_points.h"

namespace batten::internal {

// All by linear least squares in rounds of Cauchy's weights.

// The directions that normals are across, the best in the first column.
Eigen::Matrix3d AcrossNormals(const OrientedPoints& oriented);

// The lines that come nearest to meeting all normals, the best and the next: c·(p × n) + c̄·n is
// least over |c| = 1. [Pottmann & Randrup 1998]
std::vector<Axis> LinesMeetingNormals(const OrientedPoints& oriented);

// The cone whose apex all tangent planes contain, and about which all points are seen under one
// angle.
std::optional<FittedSurface> ConeOfTangentPlanes(const OrientedPoints& oriented,
                                                 const Eigen::Vector3d& near);

}  // namespace batten::internal
