// SPDX-License-Identifier: MIT
// A stopwatch for the stages of a fit, in seconds.
#pragma once

#include <chrono>
#include <utility>

namespace batten::internal {

class Stopwatch {
 public:
  // Seconds since construction or the last lap.
  double Seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - last_).count();
  }
  double Lap() {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double>(now - std::exchange(last_, now)).count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace batten::internal
