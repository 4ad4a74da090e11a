// SPDX-License-Identifier: MIT
// Copies of points across periodic seams and around poles.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/outline_options.h"

namespace batten::internal {

// Adds copies of points (points and sides in spacings): across the seams of periodic directions;
// within rows of equal v that are shorter in space than half of what u says; and two rows along an
// edge that is a pole, if a point lies near it.
Eigen::Matrix2Xd WithPeriodicCopies(const Eigen::Matrix2Xd& points,
                                    const Eigen::Vector2d& sides,
                                    const OutlineOptions& options);

// The signed area of a polygon with u scaled to its length in space.
double AreaInSpace(const Eigen::Matrix2Xd& polygon, const OutlineOptions& options);

}  // namespace batten::internal
