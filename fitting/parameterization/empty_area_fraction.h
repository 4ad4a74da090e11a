// SPDX-License-Identifier: MIT
// Share of a base's rectangle that holds no points.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/point_mask.h"

namespace batten::internal {

inline constexpr double kPointsOfATile = 9;  // with so many on average hardly any is missed

// Returns the share of [0, length_u] × [0, length_v] that holds none of the parameters under a
// mask, counted in tiles that would hold nine parameters each if they were spread evenly.
double EmptyAreaFraction(const Eigen::Matrix2Xd& parameters,
                         const PointMask& mask,
                         double length_u,
                         double length_v);

}  // namespace batten::internal
