// SPDX-License-Identifier: MIT
// What the program's exit codes mean.
#pragma once

namespace batten::internal {

inline constexpr int kDone = 0;
inline constexpr int kBadInput = 1;
inline constexpr int kBadUsage = 2;
inline constexpr int kToleranceMissed = 3;
inline constexpr int kInterrupted = 130;

}  // namespace batten::internal
