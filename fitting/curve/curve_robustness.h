// SPDX-License-Identifier: MIT
// What a loss makes of a curve's data between adaptations.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "batten/fitting/robust_loss.h"
#include "fitting/curve/span_adaptation.h"

namespace batten::internal {

struct RobustCurve {
  Loss loss;
  std::optional<double> scale;  // standard deviation of good points; estimated when absent
  // Three points or more in a row far from the curve are its own: where nobody asked for a loss,
  // the curve is more likely not there yet.
  bool spare_runs;
  bool feet;           // parameters are foot points
  double least_scale;  // > 0
  std::vector<Eigen::Index> anchored;
};

// A start for the loss: least absolute distances, nearly, on the layout there is, so that whatever
// most points follow is followed. [Huber's loss with a scale well below the residuals']
SpanAdaptation NearLeastAbsolute(SpanAdaptation adapted,
                                 const RobustCurve& losses,
                                 ThreadPool& pool);

// The adapted problem with weights by the loss, times those that the data came with (`own`; empty:
// ones).
FittingProblem WeightedByLoss(const SpanAdaptation& adapted,
                              const RobustCurve& losses,
                              const Eigen::VectorXd& own,
                              ThreadPool& pool);

}  // namespace batten::internal
