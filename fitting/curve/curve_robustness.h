// SPDX-License-Identifier: MIT
// Robust weights of a curve's data between span adaptations.
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
  // Whether three or more consecutive points far from the curve count as inliers: where no loss was
  // asked for, the fit more likely has not reached them yet.
  bool spare_runs;
  bool feet;           // parameters are foot points
  double least_scale;  // > 0
  std::vector<Eigen::Index> anchored;
};

// Refits the present layout by nearly least absolute distances, as a start for the loss, so that
// the curve follows the majority of the points. [Huber's loss with a scale well below the
// residuals']
SpanAdaptation NearLeastAbsolute(SpanAdaptation adapted,
                                 const RobustCurve& losses,
                                 ThreadPool& pool);

// Returns the adapted problem with the weights of the loss times those of the data (`own`; empty:
// ones).
FittingProblem WeightedByLoss(const SpanAdaptation& adapted,
                              const RobustCurve& losses,
                              const Eigen::VectorXd& own,
                              ThreadPool& pool);

}  // namespace batten::internal
