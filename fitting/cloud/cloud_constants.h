// SPDX-License-Identifier: MIT
// Constants that several files of the room share.
#pragma once

#include <Eigen/Core>

namespace batten::internal {

// The neighbour of a point, counted from the nearest, whose distance is the point's reach.
inline constexpr int kReachNeighbour = 6;

// Share of the reach: smaller deviations count as this.
inline constexpr double kExactInReaches = 0.03;

// Usual reaches, or reaches of the points around: a point of a longer one is lonely, and its own
// counts for no more than this.
inline constexpr double kLonelier = 3;

// Points of a sample that tells what is usual: its median is off by some 2 % of a standard
// deviation (1.25 over the root of their number, for normal values).
inline constexpr Eigen::Index kTypical = 4096;

}  // namespace batten::internal
