// SPDX-License-Identifier: MIT
#include "batten/fitting/choose_smoothing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "batten/fitting/fairness.h"
#include "batten/fitting/normal_equations.h"

namespace batten {
namespace {

constexpr int kExactFreedom = 256;
constexpr int kProbes = 64;
constexpr double kLeast = -12, kMost = 9;  // powers of ten
constexpr double kFinestStep = 0.1;

FittingProblem WithSmoothing(const FittingProblem& problem, double power) {
  return problem.WithSmoothing(std::pow(10, power));
}

double Points(const FittingProblem& problem) {
  const Eigen::VectorXd& weights = problem.data().weights;
  return weights.size() > 0 ? static_cast<double>((weights.array() > 0).count())
                            : static_cast<double>(problem.size());
}

// A·x for a matrix that is not factored.
Eigen::MatrixXd Product(const BlockBandedMatrix& matrix, const Eigen::MatrixXd& x) {
  const int b = matrix.block_size();
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(x.rows(), x.cols());
  for (int row = 0; row < matrix.blocks(); ++row) {
    for (int below = 0; below <= std::min(matrix.bandwidth(), row); ++below) {
      const auto block = matrix.at(row, below);
      const int column = row - below;
      result.middleRows(row * b, b) += block * x.middleRows(column * b, b);
      if (below > 0)
        result.middleRows(column * b, b) += block.transpose() * x.middleRows(row * b, b);
    }
  }
  return result;
}

}  // namespace

double EffectiveFreedom(const FittingProblem& problem, ThreadPool& pool) {
  const SplineBasis& outer = problem.basis_u();
  const SplineBasis* inner = problem.is_curve() ? nullptr : &problem.basis_v();
  const Eigen::VectorXd u = problem.data().parameters.row(0), v = problem.data().parameters.row(1);
  const CellOrder order(outer, inner, u, v);
  const NormalEquations equations(
      outer, inner, u, v, problem.data().values, problem.data().weights, order, pool);
  const FairnessForm fairness(outer, inner);
  BlockBandedMatrix gram = EmptyMatrix(outer, inner), whole = gram;
  equations.AddTo(gram);
  equations.AddTo(whole);
  fairness.AddTo(whole, problem.smoothing() * equations.trace() / fairness.Trace());
  whole.AddToDiagonal(4 * std::numeric_limits<double>::epsilon() * equations.trace() /
                      problem.unknowns());
  const int n = problem.unknowns();
  if (!whole.Factor()) return n;
  Eigen::MatrixXd probes = Eigen::MatrixXd::Identity(n, n);
  double scale = 1;
  if (n > kExactFreedom) {
    std::mt19937_64 engine(1);
    probes = Eigen::MatrixXd::NullaryExpr(
        n, kProbes, [&](Eigen::Index, Eigen::Index) { return engine() % 2 == 0 ? 1.0 : -1.0; });
    scale = 1.0 / kProbes;
  }
  Eigen::MatrixXd solved = Product(gram, probes);
  whole.Solve(solved);
  return scale * probes.cwiseProduct(solved).sum();
}

double SmoothingByCrossValidation(const FittingProblem& problem,
                                  ThreadPool& pool,
                                  const Progress& progress) {
  const double points = Points(problem);
  const auto score = [&](double power) {
    Report(progress, "solve", (power - kLeast) / (kMost - kLeast));
    const FittingProblem trial = WithSmoothing(problem, power);
    const double freedom = std::max(1e-3 * points, points - EffectiveFreedom(trial, pool));
    return points * SolveLinear(trial, pool).residual_squares / (freedom * freedom);
  };
  double best = kLeast, least = score(best);
  const auto take = [&](double power) {
    if (power < kLeast || power > kMost) return;
    const double found = score(power);
    if (found < least) {
      least = found;
      best = power;
    }
  };
  for (double power = kLeast + 1; power <= kMost; power += 1) take(power);
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
  const double points = Points(problem);
  const auto dimension = static_cast<double>(problem.data().values.rows());
  const auto allowed = [&](double power) {
    Report(progress, "solve", (power - kLeast) / (kMost - kLeast));
    const FittingProblem trial = WithSmoothing(problem, power);
    const double freedom = points - EffectiveFreedom(trial, pool);
    return SolveLinear(trial, pool).residual_squares <= dimension * noise * noise * freedom;
  };
  if (!allowed(kLeast)) return std::pow(10, kLeast);
  double good = kLeast, bad = kMost + 1;
  while (bad - good > kFinestStep) {  // residuals rise with smoothing
    const double middle = (good + bad) / 2;
    (allowed(middle) ? good : bad) = middle;
  }
  return std::pow(10, std::min(good, kMost));
}

}  // namespace batten
