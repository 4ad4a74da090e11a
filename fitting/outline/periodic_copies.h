// SPDX-License-Identifier: MIT
// Points repeated where parameters close or run together.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/outline_options.h"

namespace batten::internal {

// Points and sides in spacings. Copies across the seams of periodic directions; where rows of equal
// v are shorter in space than half of what u says, more in their row; and two rows along an edge
// that is one point, if a point lies near it.
Eigen::Matrix2Xd WithPeriodicCopies(const Eigen::Matrix2Xd& points,
                                    const Eigen::Vector2d& sides,
                                    const OutlineOptions& options);

// The signed area of a polygon where u is as long as it is in space.
double AreaInSpace(const Eigen::Matrix2Xd& polygon, const OutlineOptions& options);

}  // namespace batten::internal
