// SPDX-License-Identifier: MIT
// Numbers that every room uses.
#pragma once

#include <limits>
#include <numbers>

namespace batten::internal {

inline constexpr double kEpsilon = std::numeric_limits<double>::epsilon();  // 2^-52
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kTurn = 2 * std::numbers::pi;  // a full turn, in radians

}  // namespace batten::internal
