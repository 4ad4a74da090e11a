// SPDX-License-Identifier: MIT
#include "fitting/least_squares/reweighting.h"

#include <algorithm>
#include <cmath>

#include "fitting/core/stopwatch.h"

namespace batten::internal {
namespace {

constexpr int kStartRounds = 8, kRounds = 16;
constexpr double kSteady = 2e-3;  // relative change of the scale

}  // namespace

FittingProblem Reweighted(const FittingProblem& problem,
                          const ReweightingOptions& options,
                          const ResidualsOf& residuals_of,
                          ThreadPool& pool,
                          std::vector<RoundSummary>& rounds) {
  const Eigen::VectorXd original = problem.data().weights.size() > 0
                                       ? problem.data().weights
                                       : Eigen::VectorXd::Ones(problem.size()).eval();
  FittingProblem current = problem;
  double previous = 0;
  for (int round = 0; round < kRounds; ++round) {
    Report(options.progress, "solve", static_cast<double>(round) / kRounds);
    Stopwatch watch;
    // A redescending loss starts only after rounds of Huber's loss.
    const bool start = round < kStartRounds && ForgetsFarPoints(options.loss);
    const Loss loss = start ? Loss::kHuber : options.loss;
    const Eigen::VectorXd residuals = residuals_of(current, SolveLinear(current, pool));
    const double scale =
        options.loss_scale.value_or(std::max(RobustScale(residuals), options.least_scale));
    current = current.WithWeights(original.cwiseProduct(LossWeights(loss, residuals, scale)));
    RoundSummary summary;
    summary.stage = "robust";
    summary.control_points_u = current.basis_u().size();
    summary.control_points_v = current.is_curve() ? 1 : current.basis_v().size();
    summary.rms = std::sqrt(residuals.squaredNorm() / static_cast<double>(residuals.size()));
    summary.max = residuals.cwiseAbs().maxCoeff();
    summary.score = scale;
    summary.seconds = watch.Lap();
    rounds.push_back(summary);
    const bool steady = std::abs(scale - previous) <= kSteady * scale;
    previous = scale;
    if (steady) {
      if (!start) break;
      round = std::max(round, kStartRounds - 1);
    }
  }
  return current;
}

}  // namespace batten::internal
