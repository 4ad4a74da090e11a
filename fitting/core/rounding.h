// SPDX-License-Identifier: MIT
// What counts as equal, as nothing and as unknown, the same in all rooms.
#pragma once

#include <limits>
#include <numbers>

namespace batten::internal {

// Relative to a size: rounding of a few operations, and what differs by no more than a construction
// of many is off by, which counts as equal.
inline constexpr double kRelativeRounding = 1e-12, kRelativelyEqual = 1e-9;

// Squares of smaller lengths vanish.
inline constexpr double kLeastSize = 1e-100;

inline constexpr double kOneDegree = std::numbers::pi / 180;  // in radians

// Of what is unknown.
inline constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

}  // namespace batten::internal
