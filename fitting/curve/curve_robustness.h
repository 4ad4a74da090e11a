// SPDX-License-Identifier: MIT
// Robust weights of a curve's data between span adaptations.
#pragma once

#include "fitting/curve/curve_task.h"
#include "fitting/curve/span_adaptation.h"

namespace batten::internal {

// Refits the present layout by nearly least absolute distances, as a start for the loss, so that
// the curve follows the majority of the points. [Huber's loss with a scale well below the
// residuals']
SpanAdaptation NearLeastAbsolute(SpanAdaptation adapted, const CurveTask& task);

// Returns the adapted problem with the weights of the loss times those of the data (`own`; empty:
// ones). Where the task asks for no loss, three or more consecutive points far from the curve count
// as inliers: the fit more likely has not reached them yet.
FittingProblem WeightedByLoss(const SpanAdaptation& adapted,
                              const CurveTask& task,
                              Loss loss,
                              const Eigen::VectorXd& own);

}  // namespace batten::internal
