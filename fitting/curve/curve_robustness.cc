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

double ScaleOf(const Eigen::VectorXd& distances, const CurveTask& task) {
  return std::max({RobustScale(distances), kCurvesAlike * task.size, kTiniestScale});
}

}  // namespace

SpanAdaptation NearLeastAbsolute(SpanAdaptation adapted, const CurveTask& task) {
  const bool all = adapted.problem.size() == task.problem.size();
  const Eigen::VectorXd own = adapted.problem.data().weights;
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::VectorXd distances =
        task.DistancesOf(adapted.problem.WithWeights(own), adapted.solution.coefficients);
    Eigen::VectorXd weights =
        LossWeights(Loss::kHuber, distances, kShareOfScale * ScaleOf(distances, task));
    if (own.size() > 0) weights.array() *= own.array();
    CorrectedFit fit = FitWithCorrection(adapted.problem.WithWeights(std::move(weights)),
                                         task.by_feet() ? 1 : 0,
                                         task.pool,
                                         all ? task.anchored : std::vector<Eigen::Index>{});
    adapted.problem = std::move(fit.problem);
    adapted.solution = std::move(fit.solution);
  }
  return adapted;
}

FittingProblem WeightedByLoss(const SpanAdaptation& adapted,
                              const CurveTask& task,
                              Loss loss,
                              const Eigen::VectorXd& own) {
  const Eigen::VectorXd distances =
      CurveDistances(adapted.problem, adapted.solution.coefficients, task.distance, task.pool);
  const double scale = task.options.loss_scale.value_or(ScaleOf(distances, task));
  Eigen::VectorXd weights = LossWeights(loss, distances, scale);
  if (!task.options.loss) RestoreRuns(weights);
  if (own.size() > 0) weights.array() *= own.array();
  return adapted.problem.WithWeights(std::move(weights));
}

}  // namespace batten::internal
