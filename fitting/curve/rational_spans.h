// SPDX-License-Identifier: MIT
// As few spans of a curve as free weights need.
#pragma once

#include <optional>

#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/optimize.h"
#include "fitting/curve/span_layout.h"

namespace batten::internal {

struct RationalSpansOptions {
  OptimizeOptions optimize;                        // weights are free
  double goal = 0;                                 // rms of the distances, in the data's units
  std::optional<double> tolerance = std::nullopt;  // that every distance keeps, beside the goal
  int most_control_points = 50;
  int foot_point_steps = 2;  // before the joint stage
};

// Few rational spans do what takes many polynomial ones: an arc of a conic is one or two. Tries 1,
// 2, 3, 4, 5, 6, 8, … equal spans between the corners of `start`, each with a joint optimisation,
// and returns the first that reaches the goal, or every tolerance where one is given. None if none
// does. Data are those of `problem`, in order; its basis is not looked at.
std::optional<OptimizeResult> FewestRationalSpans(const FittingProblem& problem,
                                                  const SpanLayout& start,
                                                  const RationalSpansOptions& options,
                                                  ThreadPool& pool);

}  // namespace batten::internal
