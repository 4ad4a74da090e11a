// SPDX-License-Identifier: MIT
#include "fitting/curve/curve_robustness.h"

#include <algorithm>
#include <utility>

#include "batten/fitting/curve_spans.h"
#include "fitting/curve/parameter_correction.h"

namespace batten::internal {
namespace {

constexpr int kRounds = 8;
constexpr double kShareOfScale = 0.2;
constexpr Eigen::Index kRun = 3;

void RestoreRuns(Eigen::VectorXd& weights) {
  for (Eigen::Index k = 0; k < weights.size();) {
    Eigen::Index end = k;
    while (end < weights.size() && weights[end] == 0) ++end;
    if (end - k >= kRun) weights.segment(k, end - k).setOnes();
    k = std::max(end, k + 1);
  }
}

}  // namespace

SpanAdaptation NearLeastAbsolute(SpanAdaptation adapted,
                                 const RobustCurve& losses,
                                 ThreadPool& pool) {
  const Eigen::VectorXd own = adapted.problem.data().weights;
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::VectorXd distances = DistancesAt(
        adapted.problem.WithWeights(own), adapted.solution.coefficients, losses.feet, pool);
    const double scale = kShareOfScale * std::max(RobustScale(distances), losses.least_scale);
    Eigen::VectorXd weights = LossWeights(Loss::kHuber, distances, scale);
    if (own.size() > 0) weights.array() *= own.array();
    CorrectedFit fit = FitWithCorrection(adapted.problem.WithWeights(std::move(weights)),
                                         losses.feet ? 1 : 0,
                                         pool,
                                         losses.anchored);
    adapted.problem = std::move(fit.problem);
    adapted.solution = std::move(fit.solution);
  }
  return adapted;
}

FittingProblem WeightedByLoss(const SpanAdaptation& adapted,
                              const RobustCurve& losses,
                              const Eigen::VectorXd& own,
                              ThreadPool& pool) {
  const Eigen::VectorXd distances =
      CurveDistances(adapted.problem,
                     adapted.solution.coefficients,
                     losses.feet ? CurveDistance::kPoint : CurveDistance::kParameter,
                     pool);
  const double scale = losses.scale.value_or(std::max(RobustScale(distances), losses.least_scale));
  Eigen::VectorXd weights = LossWeights(losses.loss, distances, scale);
  if (losses.spare_runs) RestoreRuns(weights);
  if (own.size() > 0) weights.array() *= own.array();
  return adapted.problem.WithWeights(std::move(weights));
}

}  // namespace batten::internal
