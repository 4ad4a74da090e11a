// SPDX-License-Identifier: MIT
// What the program's exit codes mean.
#pragma once

namespace batten::internal {

inline constexpr int kDone = 0;
inline constexpr int kBadInput = 1;
inline constexpr int kBadUsage = 2;
inline constexpr int kToleranceMissed = 3;
inline constexpr int kDoubtful = 4;  // written, and the first line says why it may be wrong
inline constexpr int kInterrupted = 130;

// Whether a command that ended so has written its result.
inline constexpr bool IsWritten(int code) {
  return code == kDone || code == kToleranceMissed || code == kDoubtful;
}

}  // namespace batten::internal
