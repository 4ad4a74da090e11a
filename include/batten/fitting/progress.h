// SPDX-License-Identifier: MIT
// How long work tells what it is doing, and how it is asked to stop.
#pragma once

#include <functional>
#include <stdexcept>

namespace batten {

// Called now and then with the stage's name and the fraction of it that is done (0 … 1). Returns
// whether to go on. Called from the thread that started the work.
using Progress = std::function<bool(const char* stage, double fraction)>;

// Thrown when progress asks to stop before there is any geometry to return.
class Cancelled : public std::runtime_error {
 public:
  Cancelled() : std::runtime_error("cancelled") {}
};

// Reports, and throws Cancelled when asked to stop.
inline void Report(const Progress& progress, const char* stage, double fraction) {
  if (progress && !progress(stage, fraction)) throw Cancelled();
}

}  // namespace batten
