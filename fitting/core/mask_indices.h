// SPDX-License-Identifier: MIT
// Indices of the points under a mask.
#pragma once

#include <vector>

#include "batten/fitting/point_mask.h"

namespace batten::internal {

// In increasing order; with `most`, so many of them at most, evenly by their rank.
std::vector<Eigen::Index> IndicesOf(const PointMask& mask);
std::vector<Eigen::Index> IndicesOf(const PointMask& mask, Eigen::Index most);

}  // namespace batten::internal
