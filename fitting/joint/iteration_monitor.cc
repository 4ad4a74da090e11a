// SPDX-License-Identifier: MIT
#include "fitting/joint/iteration_monitor.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace batten::internal {
namespace {

constexpr double kLeastDamping = 1e-9, kMostDamping = 1e3;
constexpr double kExactRms = 4e-9;  // of the size: exact for CAD; on from here while it falls fast
constexpr double kRoundingRms = 1e-13;  // share of the size: below it only rounding is left
constexpr double kFast = 0.25;          // share of the rms before that a fast step leaves

}  // namespace

double LimitedDamping(double damping) { return std::clamp(damping, kLeastDamping, kMostDamping); }

bool IterationMonitor::AtNoise(const EliminatedProblem& cells, const JointOptions& options) {
  if (!options.stop_at_noise) return false;
  const EliminatedProblem::Explained explained = cells.NoiseShare();
  return explained.squares <= (1 + options.noise_slack) * explained.by_noise;
}

bool IterationMonitor::Cancelled(int iterations) {
  if (options_.progress &&
      !options_.progress("optimize", static_cast<double>(iterations) / options_.max_iterations)) {
    result_.cancelled = true;
  }
  return result_.cancelled;
}

void IterationMonitor::Record(double cost, double seconds) {
  RoundSummary round;
  round.stage = "joint";
  round.control_points_u = cells_.shape().basis_u.size();
  round.control_points_v = cells_.shape().size_v();
  round.rms = std::sqrt(cells_.SquaredDistances() / static_cast<double>(cells_.feet().cols()));
  round.score = 2 * cost;
  round.seconds = seconds;
  result_.rounds.push_back(round);
}

bool IterationMonitor::Settled() {
  if (AtNoise(cells_, options_)) {
    result_.SayAtNoise();
    return true;
  }
  const std::vector<RoundSummary>& rounds = result_.rounds;
  const double rms = rounds.back().rms;
  const bool fast = rounds.size() > 1 && rms < kFast * rounds[rounds.size() - 2].rms;
  return rms <= (fast ? kRoundingRms : kExactRms) * options_.size;
}

}  // namespace batten::internal
