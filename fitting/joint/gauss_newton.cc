// SPDX-License-Identifier: MIT
#include "fitting/joint/gauss_newton.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "fitting/core/stopwatch.h"
#include "fitting/joint/gauss_newton_system.h"
#include "fitting/joint/iteration_monitor.h"

namespace batten::internal {
namespace {

constexpr double kLeastShare = 1e-3;  // share of the predicted fall: a step with less is refused
constexpr double kNoStep = 1e-14;     // share of the net's size

class Descent {
 public:
  Descent(EliminatedProblem& cells,
          const std::vector<bool>& fixed,
          const JointOptions& options,
          ThreadPool& pool,
          JointResult& result)
      : cells_(cells),
        options_(options),
        result_(result),
        watch_(cells, options, result),
        damping_(cells.damping),
        used_damping_(damping_),
        system_(cells, fixed, pool),
        net_(cells.net()),
        cost_(cells.Cost(0)) {
    system_.Refresh();
  }

  void Run() {
    watch_.Record(cost_, clock_.Seconds());
    if (watch_.Cancelled(0) || watch_.Settled()) return;
    int refusals = 0;
    while (refusals <= kMostRefusals && GoesOn()) {
      const Stopwatch clock;
      const std::optional<GaussNewtonSystem::Step> step = system_.Solve(used_damping_);
      ++result_.iterations;
      const Trial trial = step ? Try(*step) : Trial{};
      if (trial.end) {
        watch_.Cancelled(result_.iterations);
        return;
      }
      if (!trial.taken) {
        damping_ = std::max(damping_, used_damping_);  // never less than what was refused
        Damp(std::pow(2.0, ++refusals));
        used_damping_ = damping_;
      } else {
        refusals = 0;
        used_damping_ = damping_;
        Damp(std::max(0.2, 1 - std::pow(2 * trial.gain - 1, 3)));
        watch_.Record(cost_, clock.Seconds());
      }
      if (watch_.Cancelled(result_.iterations) || (trial.taken && watch_.Settled())) return;
    }
  }

 private:
  struct Trial {
    bool taken = false, end = false;
    double gain = 0;  // of what was promised
  };

  bool GoesOn() const {
    return result_.iterations < options_.max_iterations && system_.steepness() > 0 &&
           (options_.seconds <= 0 || clock_.Seconds() < options_.seconds);
  }

  Trial Try(const GaussNewtonSystem::Step& step) {
    if (!(step.promise > 0)) return {};
    if (step.net.norm() <= kNoStep * net_.norm()) return {.end = true};
    cells_.SetNet(net_ + step.net);
    const double cost =
        cells_.Project() ? cells_.Cost(used_damping_) : std::numeric_limits<double>::infinity();
    const double fall = cost_ - cost;
    if (std::abs(fall) <= options_.least_gain * cost_ || !(fall > kLeastShare * step.promise)) {
      cells_.SetNet(net_);
      return {.end = std::abs(fall) <= options_.least_gain * cost_};
    }
    net_ = cells_.net();
    cells_.AcceptState();
    cost_ = cells_.Cost(0);
    system_.Refresh();
    return {.taken = true, .gain = fall / step.promise};
  }

  void Damp(double factor) { damping_ = LimitedDamping(damping_ * factor); }

  EliminatedProblem& cells_;
  const JointOptions& options_;
  JointResult& result_;
  IterationMonitor watch_;
  Stopwatch clock_;
  double damping_, used_damping_;  // the first takes effect a step late, which keeps edges smooth
  GaussNewtonSystem system_;
  Eigen::MatrixXd net_;  // accepted
  double cost_;          // of it
};

}  // namespace

void DescendJointly(EliminatedProblem& cells,
                    const std::vector<bool>& fixed,
                    const JointOptions& options,
                    ThreadPool& pool,
                    JointResult& result) {
  cells.AcceptState();
  Descent(cells, fixed, options, pool, result).Run();
}

}  // namespace batten::internal
