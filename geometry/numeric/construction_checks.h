// SPDX-License-Identifier: MIT
// Preconditions of constructions. Each throws std::invalid_argument naming function, value and
// rule.
#pragma once

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "batten/geometry/frame.h"
#include "geometry/numeric/number_text.h"

namespace batten::internal {

inline void RequireThat(bool holds, const char* function, const std::string& what) {
  if (!holds) throw std::invalid_argument(std::string(function) + ": " + what);
}

// `reason` says what the function would lose.
inline void RefuseTrims(bool trimmed, const char* function, const char* reason) {
  RequireThat(!trimmed, function, std::string("the surface is trimmed, and ") + reason);
}

inline void RequirePositive(const char* function, const char* name, double value) {
  RequireThat(value > 0 && std::isfinite(value),
              function,
              std::string(name) + " = " + NumberText(value) + " is not positive and finite");
}

inline void RequireSweep(const char* function, const char* name, const AngleRange& angles) {
  constexpr double kSlack = 1e-12;
  RequireThat(std::isfinite(angles.start),
              function,
              std::string(name) + ".start = " + NumberText(angles.start) + " is not finite");
  RequireThat(angles.sweep > 0 && angles.sweep <= 2 * std::numbers::pi + kSlack,
              function,
              std::string(name) + ".sweep = " + NumberText(angles.sweep) + " is not in (0, 2 pi]");
}

inline void RequireIncreasing(const char* function, const char* name, const Interval& interval) {
  RequireThat(std::isfinite(interval.lower) && std::isfinite(interval.upper) &&
                  interval.lower < interval.upper,
              function,
              std::string(name) + " = " + IntervalText(interval.lower, interval.upper) +
                  " is not an increasing finite interval");
}

}  // namespace batten::internal
