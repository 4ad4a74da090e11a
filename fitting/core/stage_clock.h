// SPDX-License-Identifier: MIT
// The clock of a fit's stages: every moment belongs to one of them.
#pragma once

#include "batten/fitting/fit_report.h"
#include "fitting/core/stopwatch.h"

namespace batten::internal {

class StageClock {
 public:
  using Stage = double StageSeconds::*;

  explicit StageClock(Stage first = &StageSeconds::prepare) : stage_(first) {}

  // Ends the present stage. A stage may be entered again and again.
  void Enter(Stage next) {
    Charge();
    stage_ = next;
  }

  // The seconds of all stages so far, and their sum.
  StageSeconds Seconds() {
    Charge();
    return seconds_;
  }

 private:
  void Charge() {
    const double lap = watch_.Lap();
    seconds_.*stage_ += lap;
    seconds_.total += lap;
  }

  Stopwatch watch_;
  StageSeconds seconds_;
  Stage stage_;
};

}  // namespace batten::internal
