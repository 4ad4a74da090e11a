// SPDX-License-Identifier: MIT
// Angles in radians.
#pragma once

#include <numbers>

namespace batten::internal {

inline constexpr double kPi = std::numbers::pi;

}  // namespace batten::internal
