// SPDX-License-Identifier: MIT
// Adaptive knot spans of a curve: refinement and knot removal by the noise or a tolerance.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "batten/fitting/fit_report.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/progress.h"
#include "batten/fitting/solve_linear.h"
#include "fitting/curve/span_layout.h"

namespace batten::internal {

struct SpanAdaptOptions {
  // Distance in the data's units, > 0: spans are halved only where it is missed, knots removed as
  // long as it is kept. Absent: spans are halved where the data show a significant gain, knots
  // removed where they show none.
  std::optional<double> tolerance = std::nullopt;
  bool feet = true;  // parameters move to the foot points, distances are across the curve
  double exact = 0;  // differences below this are none, in the data's units
  double noise = 0;  // standard deviation to be expected, per coordinate; where residuals are far
                     // above it, fewer data are enough to halve a span
  std::vector<Eigen::Index> anchored = {};  // data that keep their parameters: those at corners
  int max_control_points = 2000;
  Progress progress = nullptr;
};

struct SpanAdaptation {
  SpanLayout layout;
  FittingProblem problem;   // over the layout's basis; parameters are foot points if they may move
  LinearSolution solution;  // of it
  double noise = 0;         // standard deviation across the curve, per coordinate
  bool full = false;        // max_control_points stopped it
  std::vector<RoundSummary> rounds;
};

// Refines the spans in rounds: solve and move parameters to the foot points; solve with every span
// halved that holds data enough; from the finer residuals' successive differences, which bias
// hardly enters, the variance of the noise; halve every span in which the two curves differ by more
// than four variances. A residual's own size can't show a bias below the noise; this difference
// does. Then knots whose removal costs less than noise would are removed, a few at a time. Data are
// those of `problem` in any order; its basis is ignored. O(m) for each of about ten rounds.
// [successive differences: von Neumann 1941; knot removal by its cost: Wald's test]
SpanAdaptation AdaptSpans(const FittingProblem& problem,
                          const SpanLayout& start,
                          const SpanAdaptOptions& options,
                          ThreadPool& pool);

// Refits the same data with fewer, relocated knots, where that explains the data better for the
// number of knots: several counts are tried, from even spans and from the adapted ones, each
// relocated (knot_relocation.h). For noise-thick data; O(spans² · 10) for each of six trials,
// twelve where data are few.
SpanAdaptation RelocatedSpans(SpanAdaptation adapted,
                              const SpanAdaptOptions& options,
                              ThreadPool& pool);

// Refits with the fewest relocated knots that keep the tolerance, fewer than there are, or some
// more where it is not kept yet. Returns the adaptation unchanged where no such layout is found.
SpanAdaptation RelocatedWithinTolerance(SpanAdaptation adapted,
                                        const SpanAdaptOptions& options,
                                        ThreadPool& pool);

}  // namespace batten::internal
