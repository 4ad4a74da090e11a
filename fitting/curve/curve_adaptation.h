// SPDX-License-Identifier: MIT
// Adaptation of a curve's spans to its points, with and without corners, with and without a loss.
#pragma once

#include "fitting/curve/curve_task.h"
#include "fitting/curve/span_adaptation.h"

namespace batten::internal {

inline constexpr Eigen::Index kManyCurvePoints = 20000;  // above, means of rows are fitted first …
inline constexpr Eigen::Index kCurveMeans = 4000;        // … so many
inline constexpr int kMostSpansToRelocate = 80;  // the time of relocation grows with their square
inline constexpr int kStartSpans = 15;

// The options of span adaptation for the task.
SpanAdaptOptions AdaptOptions(const CurveTask& task);

// Adapts from a few equal spans to as many as the data distinguish or the tolerance needs, with the
// corners that were found. Those of few points were sought as if these had no noise: where the
// curve shows that they have, the task's corners are cleared and the curve is smooth.
SpanAdaptation AdaptedSpans(CurveTask& task, const FittingProblem& problem);

// Adapts to all points of the task or, where they are many, to means of them, under the loss if
// any; what comes back has all points, with the weights of the loss. Appends to `rounds`.
SpanAdaptation AdaptedToPoints(CurveTask& task,
                               std::optional<Loss> loss,
                               std::vector<RoundSummary>& rounds);

}  // namespace batten::internal
