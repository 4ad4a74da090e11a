// SPDX-License-Identifier: MIT
// The fewest rational spans, with free weights, that fit a curve's data.
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
};

// Finds the fewest rational spans that reach a goal; few of them replace many polynomial ones, an
// arc of a conic takes one or two. Tries 1, 2, 3, 4, 5, 6, 8, … equal spans between the corners of
// `start`, each with a joint optimisation, and returns the first that reaches the goal, or every
// tolerance where one is given. Returns nullopt if none does. Data are those of `problem`, in
// order; its basis is ignored.
std::optional<OptimizeResult> FewestRationalSpans(const FittingProblem& problem,
                                                  const SpanLayout& start,
                                                  const RationalSpansOptions& options,
                                                  ThreadPool& pool);

}  // namespace batten::internal
