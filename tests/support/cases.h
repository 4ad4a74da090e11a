// SPDX-License-Identifier: MIT
// How many cases a law is tried on.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace batten {

// `quick` cases times the environment variable BATTEN_CASES (1 if unset, at least 1 case):
// scripts/check-long tries every law of the quick suite on several times the cases, with further
// seeds where a case's number is its seed.
inline int Cases(int quick) {
  const char* const factor = std::getenv("BATTEN_CASES");
  if (factor == nullptr) return quick;
  return static_cast<int>(std::clamp(std::round(quick * std::strtod(factor, nullptr)), 1.0, 1e9));
}

}  // namespace batten
