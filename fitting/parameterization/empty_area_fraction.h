// SPDX-License-Identifier: MIT
// How much of a base's rectangle its points leave open.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/point_mask.h"

namespace batten::internal {

// The share of [0, length_u] × [0, length_v] that holds none of the parameters under a mask: of
// tiles that would hold nine each if they were spread evenly.
double EmptyAreaFraction(const Eigen::Matrix2Xd& parameters,
                         const PointMask& mask,
                         double length_u,
                         double length_v);

}  // namespace batten::internal
