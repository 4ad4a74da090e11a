// SPDX-License-Identifier: MIT
// How far a whole fit has come.
#pragma once

#include <functional>

#include "batten/fitting/progress.h"

namespace batten {

// The stages of a fit, in the order in which they are entered.
enum class FitStage {
  kPrepare,       // spacing, noise, outliers
  kOrder,         // of the points along a curve
  kParameterize,  // base surface and parameters
  kSolve,         // control points and knots
  kRefine,        // knots until the tolerance is kept
  kOptimize,      // control points, parameters, weights and knots together
  kMeasure,       // distances of all points
};

struct FitProgress {
  FitStage stage = FitStage::kPrepare;
  double stage_fraction = 0;  // of the stage, 0 … 1; goes back where a stage is run again
  double fraction = 0;        // of the whole fit, 0 … 1; never goes back
};

// A callback for the options of one fit that hands on where the whole fit is, in place of a stage's
// name and its own fraction. `callback` returns whether to go on; what it throws leaves the fit.
// Stages take the shares of time that they usually do: where one is skipped the fraction jumps.
Progress WholeFit(std::function<bool(const FitProgress&)> callback);

}  // namespace batten
