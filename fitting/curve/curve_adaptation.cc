// SPDX-License-Identifier: MIT
#include "fitting/curve/curve_adaptation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "fitting/core/rules.h"
#include "fitting/curve/curve_robustness.h"
#include "fitting/curve/parameter_correction.h"
#include "fitting/ordering/row_means.h"

namespace batten::internal {
namespace {

constexpr int kRobustPasses = 3;
constexpr double kExactAgainstNoise = 0.2;
constexpr int kStartForTolerance = 5;
constexpr Eigen::Index kPointsOfStartSpan = 8;
constexpr Eigen::Index kManyUnderLoss = 10000;

SpanAdaptation AdaptedBetween(const CurveTask& task,
                              const FittingProblem& problem,
                              const std::vector<double>& corners) {
  const CurveFitOptions& options = task.options;
  const bool closed = task.ordered.closed;
  const Eigen::Index few = std::max<Eigen::Index>(1, problem.size() / kPointsOfStartSpan);
  const int start = options.tolerance ? kStartForTolerance : kStartSpans;
  const auto sharp = static_cast<int>(corners.size());
  const int room =
      options.max_control_points - (closed ? 0 : options.degree) - sharp * (options.degree - 1);
  const int spans = std::min(static_cast<int>(std::min<Eigen::Index>(start, few)), room);
  // Around a closed curve more control points than the degree.
  const int least = options.degree + 1 - (options.degree - 1) * sharp;
  const int fewest = std::max({1, sharp, closed ? least : 1});
  const SpanAdaptOptions adapt = AdaptOptions(task);
  SpanAdaptation adapted =
      AdaptSpans(problem, task.EqualSpans(std::max(fewest, spans), corners), adapt, task.pool);
  if (adapted.layout.spans() > kMostSpansToRelocate || !Acts(Rule::kRelocatedKnots)) return adapted;
  return options.tolerance ? RelocatedWithinTolerance(std::move(adapted), adapt, task.pool)
                           : RelocatedSpans(std::move(adapted), adapt, task.pool);
}

void Append(std::vector<RoundSummary>& rounds, const SpanAdaptation& adapted) {
  rounds.insert(rounds.end(), adapted.rounds.begin(), adapted.rounds.end());
}

// Adaptation and weights in turn; the problem that comes back has the weights of the loss.
SpanAdaptation AdaptedUnderLoss(CurveTask& task,
                                const FittingProblem& problem,
                                Loss loss,
                                std::vector<RoundSummary>& rounds) {
  SpanAdaptation adapted = AdaptedSpans(task, problem);
  Append(rounds, adapted);
  if (task.noise == 0) task.noise = adapted.noise;
  const Eigen::VectorXd own = problem.data().weights;
  if (Acts(Rule::kLeastAbsolute)) adapted = NearLeastAbsolute(std::move(adapted), task);
  for (int pass = 0; pass < kRobustPasses; ++pass) {
    const FittingProblem weighted = WeightedByLoss(adapted, task, loss, own);
    adapted = AdaptedSpans(task, weighted);
    Append(rounds, adapted);
  }
  adapted.problem = WeightedByLoss(adapted, task, loss, own);
  return adapted;
}

// All data at their foot points on a curve fitted to some of them or to means, weighted by the
// loss.
FittingProblem WeightedWhole(const CurveTask& task, const SpanAdaptation& part, Loss loss) {
  const FittingProblem whole = task.problem.WithBasis(part.layout.Basis());
  const SpanAdaptation all{
      part.layout,
      task.by_feet()
          ? CorrectedParameters(whole, part.solution.coefficients, task.pool, task.anchored)
          : whole,
      part.solution,
      part.noise,
      part.full,
      {}};
  return WeightedByLoss(all, task, loss, whole.data().weights);
}

}  // namespace

SpanAdaptOptions AdaptOptions(const CurveTask& task) {
  SpanAdaptOptions adapt;
  adapt.tolerance = task.options.tolerance;
  adapt.feet = task.by_feet();
  adapt.exact = kCurvesAlike * task.size;
  adapt.noise = task.noise;
  if (task.problem.size() <= kManyCurvePoints) adapt.anchored = task.anchored;
  adapt.max_control_points = task.options.max_control_points;
  adapt.progress = task.options.progress;
  return adapt;
}

SpanAdaptation AdaptedSpans(CurveTask& task, const FittingProblem& problem) {
  SpanAdaptation sharp = AdaptedBetween(task, problem, task.corners);
  if (task.corners.empty() || task.near_exact || !task.sought_as_exact) return sharp;
  const Eigen::VectorXd off = task.DistancesOf(sharp.problem, sharp.solution.coefficients);
  const double left = std::sqrt(off.squaredNorm() / static_cast<double>(problem.size()));
  if (left < kExactAgainstNoise * task.ordered.noise) return sharp;
  task.corners.clear();
  task.anchored.clear();
  return AdaptedBetween(task, problem, {});
}

SpanAdaptation AdaptedToPoints(CurveTask& task,
                               std::optional<Loss> loss,
                               std::vector<RoundSummary>& rounds) {
  const bool many = task.problem.size() > kManyCurvePoints && !task.options.tolerance;
  if (!loss) {
    SpanAdaptation adapted =
        AdaptedSpans(task, many ? MeansOfRows(task.problem, kCurveMeans) : task.problem);
    Append(rounds, adapted);
    const double means = many ? static_cast<double>(task.problem.size()) / kCurveMeans : 1;
    if (task.noise == 0) task.noise = adapted.noise * std::sqrt(means);
    if (many) adapted.problem = task.problem.WithBasis(adapted.layout.Basis());
    return adapted;
  }
  SpanAdaptation adapted = AdaptedUnderLoss(
      task, many ? EveryFewData(task.problem, kManyUnderLoss) : task.problem, *loss, rounds);
  if (!many) return adapted;
  // To all data, with the outliers taken from a fit to some of them.
  adapted = AdaptedSpans(task, MeansOfRows(WeightedWhole(task, adapted, *loss), kCurveMeans));
  Append(rounds, adapted);
  adapted.problem = WeightedWhole(task, adapted, *loss);
  return adapted;
}

}  // namespace batten::internal
