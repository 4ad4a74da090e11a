// SPDX-License-Identifier: MIT
#include "fitting/least_squares/choose_smoothing.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <stdexcept>
#include <vector>

#include "batten/fitting/solve_linear.h"
#include "fitting/core/rounding.h"
#include "fitting/least_squares/fitting_bases.h"
#include "fitting/least_squares/penalised_system.h"
#include "fitting/linear/tied_system.h"

namespace batten::internal {
namespace {

constexpr int kExactFreedom = 256;
constexpr int kMostProbes = 64, kFewestProbes = 16;
constexpr int kForMostProbes = 1024;  // control points; the more, the fewer probes are as exact
constexpr Eigen::Index kColumns = 16;
constexpr double kLeast = -12, kMostPower = 9;  // powers of ten
constexpr double kFinestStep = 0.1;

Eigen::Index Probes(int unknowns) {
  return std::clamp(kMostProbes * kForMostProbes / unknowns, kFewestProbes, kMostProbes);
}

// One problem solved at several smoothings; its data are assembled once.
class Trials {
 public:
  Trials(const FittingProblem& problem, ThreadPool& pool)
      : problem_(problem), pool_(pool), system_(problem, pool) {
    const int n = system_.unknowns();
    if (n > kExactFreedom) {
      std::mt19937_64 engine(1);
      probes_ = Eigen::MatrixXd::NullaryExpr(
          n, Probes(n), [&](Eigen::Index, Eigen::Index) { return engine() % 2 == 0 ? 1.0 : -1.0; });
      scale_ = 1.0 / static_cast<double>(probes_.cols());
    } else {
      probes_ = Eigen::MatrixXd::Identity(n, n);
    }
    applied_ = system_.Matrix(0, 0).Times(probes_);
  }

  struct Trial {
    double freedom, residual_squares;
  };
  Trial At(double smoothing) const {
    const PenalisedSystem::Solution solution = system_.Solve(smoothing);
    Trial trial{FreeVariables(solution.factor), solution.residual_squares};
    // Below this share of the sum of squares, cancellation leaves no digits.
    if (trial.residual_squares < kRelativelyEqual * system_.squares())
      trial.residual_squares =
          SolveLinear(problem_.WithSmoothing(smoothing), pool_).residual_squares;
    return trial;
  }

 private:
  // Works in parts of a fixed number of columns, so that the result does not depend on threads.
  double FreeVariables(const TiedSystem& factor) const {
    const Eigen::Index parts = (probes_.cols() + kColumns - 1) / kColumns;
    std::vector<double> sums(static_cast<size_t>(parts), 0.0);
    pool_.For(parts, 1, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      for (std::ptrdiff_t part = begin; part < end; ++part) {
        const Eigen::Index first = part * kColumns,
                           count = std::min<Eigen::Index>(kColumns, probes_.cols() - first);
        Eigen::MatrixXd solved = applied_.middleCols(first, count);
        factor.Solve(solved);
        sums[static_cast<size_t>(part)] =
            probes_.middleCols(first, count).cwiseProduct(solved).sum();
      }
    });
    return scale_ * std::accumulate(sums.begin(), sums.end(), 0.0);
  }

  const FittingProblem& problem_;
  ThreadPool& pool_;
  PenalisedSystem system_;
  Eigen::MatrixXd probes_, applied_;  // z and Az
  double scale_ = 1;
};

}  // namespace

double EffectiveFreedom(const FittingProblem& problem, ThreadPool& pool) {
  return Trials(problem, pool).At(problem.smoothing()).freedom;
}

double SmoothingByCrossValidation(const FittingProblem& problem,
                                  ThreadPool& pool,
                                  const Progress& progress) {
  const double points = PointCount(problem);
  const Trials trials(problem, pool);
  const auto score = [&](double power) {
    Report(progress, "solve", (power - kLeast) / (kMostPower - kLeast));
    const Trials::Trial trial = trials.At(std::pow(10, power));
    const double freedom = std::max(1e-3 * points, points - trial.freedom);
    return points * trial.residual_squares / (freedom * freedom);
  };
  double best = kLeast, least = score(best);
  const auto take = [&](double power) {
    if (power < kLeast || power > kMostPower) return;
    const double found = score(power);
    if (found < least) {
      least = found;
      best = power;
    }
  };
  for (double power = kLeast + 1; power <= kMostPower; power += 1) take(power);
  for (double step = 0.5; step >= kFinestStep; step /= 2) {
    const double middle = best;
    take(middle - step);
    take(middle + step);
  }
  return std::pow(10, best);
}

double SmoothingFromNoise(const FittingProblem& problem,
                          double noise,
                          ThreadPool& pool,
                          const Progress& progress) {
  if (!(noise > 0) || !std::isfinite(noise))
    throw std::invalid_argument("SmoothingFromNoise: the noise must be positive");
  const double points = PointCount(problem);
  const Trials trials(problem, pool);
  const auto dimension = static_cast<double>(problem.data().values.rows());
  const auto allowed = [&](double power) {
    Report(progress, "solve", (power - kLeast) / (kMostPower - kLeast));
    const Trials::Trial trial = trials.At(std::pow(10, power));
    return trial.residual_squares <= dimension * noise * noise * (points - trial.freedom);
  };
  if (!allowed(kLeast)) return std::pow(10, kLeast);
  double good = kLeast, bad = kMostPower + 1;
  while (bad - good > kFinestStep) {  // residuals rise with smoothing
    const double middle = (good + bad) / 2;
    (allowed(middle) ? good : bad) = middle;
  }
  return std::pow(10, std::min(good, kMostPower));
}

}  // namespace batten::internal
