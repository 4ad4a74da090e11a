// SPDX-License-Identifier: MIT
#include "fitting/surface/bounded_solution.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "batten/fitting/robust_loss.h"
#include "fitting/core/rounding.h"
#include "fitting/core/rules.h"
#include "fitting/core/shared_constants.h"
#include "fitting/least_squares/fitting_bases.h"
#include "fitting/least_squares/penalised_system.h"
#include "fitting/surface/coefficient_bounds.h"
#include "fitting/surface/data_box.h"

namespace batten::internal {
namespace {

// Slack of the bounds in spacings, beside three standard deviations: points may as well lie so far
// apart.
constexpr double kOfSpacing = 1;
constexpr double kCostOfHolding = 1.44;  // of the sum of squares, in a box
// A coefficient that the points do not ask for costs nothing when held, but for chance: so many
// times its share of the variance. Of points followed to their noise, bounds and boxes that cost
// more, and more than a share of what the unknowns cost by chance, are too narrow.
constexpr double kOfChance = 6, kOfFreedom = 0.2;
constexpr int kWidenings = 3;  // each time twice as wide

// Relative fairness of the smooth shape that bounds are about: it bends over some three cells,
// where the fit (1e-4) bends within one, so that it goes on over a cell without data as those
// around do. 1 to 1000 predict left-out points of terrain as well; 1 lets overshoots of 398 points
// in 9 x 8 control points pass.
constexpr double kSmoothShape = 100;

// The active set and its solutions.
class ActiveSet {
 public:
  ActiveSet(const PenalisedSystem& system,
            double smoothing,
            Eigen::MatrixXd free,
            CoefficientBounds bounds,
            ThreadPool& pool)
      : system_(system),
        matrix_(system.Matrix(smoothing, 1)),
        net_(std::move(free)),
        bounds_(std::move(bounds)),
        held_(static_cast<size_t>(net_.cols()), 0),
        pool_(pool) {}

  // Holds what leaves its interval. Returns whether anything does.
  bool HoldWhatLeaves() {
    bool any = false;
    for (Eigen::Index k = 0; k < net_.cols(); ++k) {
      if (held_[static_cast<size_t>(k)]) continue;
      const double height = bounds_.HeightOf(net_, k);
      const double inside = std::clamp(height, bounds_.low[k], bounds_.high[k]);
      // What was just released is at its bound but for rounding.
      if (!(std::abs(height - inside) > kRelativelyEqual * (bounds_.high[k] - bounds_.low[k])))
        continue;
      bounds_.SetHeight(net_, k, inside);
      held_[static_cast<size_t>(k)] = height < inside ? -1 : 1;
      any = true;
    }
    return any;
  }

  // Releases what the sum of squares draws inwards. Returns whether anything is.
  bool Release() {
    bool any = false;
    const Eigen::MatrixXd gradient = matrix_.Times(Rows()) - system_.rhs();
    for (Eigen::Index k = 0; k < net_.cols(); ++k) {
      char& held = held_[static_cast<size_t>(k)];
      if (held == 0) continue;
      const auto slope = gradient.row(system_.RowOf(k));
      const double along = net_.rows() == 1 ? slope[0] : slope.dot(bounds_.up.col(k).transpose());
      if (held * along <= 0) continue;
      held = 0;
      any = true;
    }
    return any;
  }

  // Solves for what is not held. Returns false, and changes nothing, where that fails.
  bool Solve() {
    std::vector<Eigen::Index> fixed;
    for (size_t k = 0; k < held_.size(); ++k)
      if (held_[k] != 0) fixed.push_back(system_.RowOf(static_cast<Eigen::Index>(k)));
    const Eigen::MatrixXd all = Rows();
    Eigen::MatrixXd kept = Eigen::MatrixXd::Zero(all.rows(), all.cols());
    kept(fixed, Eigen::all) = all(fixed, Eigen::all);
    BlockBandedMatrix reduced = matrix_;
    const double unit = matrix_.Trace() / system_.unknowns();
    Eigen::MatrixXd rows = system_.rhs() - matrix_.Times(kept);
    reduced.Pin(fixed, unit);
    rows(fixed, Eigen::all) = unit * kept(fixed, Eigen::all);
    if (!reduced.Factor(&pool_)) return false;
    reduced.Solve(rows);
    Eigen::MatrixXd solved = system_.Net(rows);
    if (!solved.allFinite()) return false;
    net_ = std::move(solved);
    return true;
  }

  const Eigen::MatrixXd& net() const { return net_; }
  int held() const {
    return static_cast<int>(
        std::count_if(held_.begin(), held_.end(), [](char one) { return one != 0; }));
  }

 private:
  Eigen::MatrixXd Rows() const {
    Eigen::MatrixXd rows(system_.unknowns(), net_.rows());
    for (Eigen::Index k = 0; k < net_.cols(); ++k)
      rows.row(system_.RowOf(k)) = net_.col(k).transpose();
    return rows;
  }

  const PenalisedSystem& system_;
  BlockBandedMatrix matrix_;
  Eigen::MatrixXd net_;
  CoefficientBounds bounds_;
  std::vector<char> held_;  // −1: at the lower bound, 1: at the upper
  ThreadPool& pool_;
};

// Bounds by data nearby, where these leave cells without data.
void HoldCoefficients(const FittingProblem& problem,
                      const PenalisedSystem& system,
                      double spacing,
                      ThreadPool& pool,
                      int most_rounds,
                      bool at_noise,
                      BoundedSolution& bounded) {
  if (problem.poles().any() || FillsEveryCell(problem)) return;
  LinearSolution& solution = bounded.solution;
  const double smoothing = std::max(kSmoothShape, problem.smoothing());
  const Eigen::MatrixXd smooth = system.Net(system.Solve(smoothing, &pool).rows);
  const double noise =
      RobustScale((EvaluateAt(problem, solution.coefficients, pool) - problem.data().values)
                      .colwise()
                      .norm()
                      .transpose());
  CoefficientBounds bounds =
      BoundsFromData(problem, smooth, kThreeSigmas * noise + kOfSpacing * spacing, pool);
  const double squares = solution.residual_squares;
  const Eigen::MatrixXd free = solution.coefficients;
  for (int time = 0; bounds.Leaves(free); ++time) {
    ActiveSet set(system, problem.smoothing(), free, bounds, pool);
    set.HoldWhatLeaves();
    bool changed = true;
    for (int round = 1; changed && round <= most_rounds && set.Solve(); ++round) {
      changed = round < most_rounds && set.Release();
      changed = set.HoldWhatLeaves() || changed;
    }
    solution.coefficients = set.net();
    bounded.held = set.held();
    solution.residual_squares = SquaresOf(problem, solution.coefficients, pool);
    const double allowed = std::max(kOfChance * set.held(), kOfFreedom * problem.unknowns()) /
                           static_cast<double>(problem.size());
    if (!at_noise || time == kWidenings || solution.residual_squares <= (1 + allowed) * squares)
      return;
    bounds.Widen(2);
  }
  solution.coefficients = free;
  solution.residual_squares = squares;
  bounded.held = 0;
}

}  // namespace

BoundedSolution SolveWithinBounds(const FittingProblem& problem,
                                  double spacing,
                                  ThreadPool& pool,
                                  double held_rms,
                                  double noise,
                                  int most_rounds) {
  const PenalisedSystem system(problem, pool);
  const PenalisedSystem::Solution plain = system.Solve(problem.smoothing(), &pool);
  BoundedSolution bounded{{system.Net(plain.rows), 0, plain.raised}};
  bounded.solution.residual_squares = SquaresOf(problem, bounded.solution.coefficients, pool);
  if (!Acts(Rule::kBounds)) return bounded;
  const double all = WeightOf(problem), squares = bounded.solution.residual_squares;
  const bool at_noise = squares <= kAtNoise * kAtNoise * noise * noise * all;
  HoldCoefficients(problem, system, spacing, pool, most_rounds, at_noise, bounded);
  const double limit =
      at_noise ? (1 + kOfFreedom * problem.unknowns() / static_cast<double>(problem.size())) *
                     std::max(squares, bounded.solution.residual_squares)
               : kCostOfHolding * bounded.solution.residual_squares;
  double grown = 1;
  for (int time = 0; time <= (at_noise ? kWidenings : 0); ++time, grown *= 2) {
    auto inside = HeldInBox(problem, bounded.solution, pool, grown);
    if (!inside) break;
    if (inside->residual_squares > std::max(limit, held_rms * held_rms * all)) continue;
    bounded.solution = std::move(*inside);
    bounded.in_box = true;
    break;
  }
  return bounded;
}

}  // namespace batten::internal
