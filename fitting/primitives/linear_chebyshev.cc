// SPDX-License-Identifier: MIT
#include "fitting/primitives/linear_chebyshev.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "fitting/core/rounding.h"
#include "fitting/core/shared_constants.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

// A reference: points with the signs of their residuals, and multipliers that sum to one with
// Σ multiplier · sign · J_k = 0.
struct Reference {
  std::vector<Eigen::Index> points;
  Eigen::VectorXd signs, multipliers;
};

// n + 1 points whose rows have full rank: those of a rank-revealing factorization, and the one
// farthest off beside them.
Reference StartFrom(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residuals) {
  const Eigen::Index n = jacobian.cols();
  Reference start;
  start.points = LeadingColumns(jacobian.transpose());
  Eigen::Index farthest = 0;
  double most = -1;
  for (Eigen::Index k = 0; k < residuals.size(); ++k) {
    if (std::abs(residuals[k]) <= most) continue;
    if (std::find(start.points.begin(), start.points.end(), k) != start.points.end()) continue;
    most = std::abs(residuals[k]);
    farthest = k;
  }
  start.points.push_back(farthest);
  // J_farthest = Σ c_k J_k: the null vector (−c, 1).
  Eigen::VectorXd null(n + 1);
  const Eigen::MatrixXd rows = jacobian(start.points, Eigen::all);
  null.head(n) = -SquareSolution(rows.topRows(n).transpose(), rows.row(n).transpose());
  null[n] = 1;
  double height = 0;
  for (Eigen::Index k = 0; k <= n; ++k)
    height += null[k] * residuals[start.points[static_cast<size_t>(k)]];
  if (height < 0) null = -null;
  start.multipliers = null.cwiseAbs() / null.cwiseAbs().sum();
  start.signs = null.unaryExpr([](double x) { return x < 0 ? -1.0 : 1.0; });
  return start;
}

}  // namespace

ChebyshevSolution SolveChebyshev(const Eigen::MatrixXd& jacobian,
                                 const Eigen::VectorXd& residuals) {
  const Eigen::Index n = jacobian.cols();
  Reference reference = StartFrom(jacobian, residuals);
  ChebyshevSolution best;
  best.x = Eigen::VectorXd::Zero(n);
  best.greatest = residuals.cwiseAbs().maxCoeff();
  for (int exchange = 0; exchange < kMostIterations; ++exchange) {
    // sign · (r + J x) = t on the reference.
    Eigen::MatrixXd system(n + 1, n + 1);
    system.leftCols(n) = reference.signs.asDiagonal() * jacobian(reference.points, Eigen::all);
    system.col(n).setConstant(-1);
    const Eigen::VectorXd right = -(reference.signs.asDiagonal() * residuals(reference.points));
    const SquareFactor factor(system);
    const Eigen::VectorXd found = factor.Solve(right);
    if (!found.allFinite()) return best;
    const Eigen::VectorXd off = residuals + jacobian * found.head(n);
    Eigen::Index farthest = 0;
    const double greatest = off.cwiseAbs().maxCoeff(&farthest);
    if (greatest < best.greatest) {
      best.greatest = greatest;
      best.x = found.head(n);
    }
    if (greatest <=
        found[n] * (1 + kRelativeRounding) + kRelativeRounding * residuals.cwiseAbs().maxCoeff()) {
      best.solved = true;
      return best;
    }
    // The entering row as a combination of those of the reference; the ratio test keeps the
    // multipliers positive.
    Eigen::VectorXd entering(n + 1);
    const double sign = off[farthest] < 0 ? -1 : 1;
    entering.head(n) = sign * jacobian.row(farthest).transpose();
    entering[n] = -1;
    const Eigen::VectorXd shares = factor.SolveTransposed(entering);
    Eigen::Index leaving = -1;
    double step = HUGE_VAL;
    for (Eigen::Index k = 0; k <= n; ++k) {
      if (!(shares[k] > kRelativeRounding)) continue;
      const double ratio = reference.multipliers[k] / shares[k];
      if (ratio < step) {
        step = ratio;
        leaving = k;
      }
    }
    if (leaving < 0) return best;
    reference.multipliers -= step * shares;
    reference.multipliers = reference.multipliers.cwiseMax(0);
    reference.multipliers[leaving] = step;
    reference.points[static_cast<size_t>(leaving)] = farthest;
    reference.signs[leaving] = sign;
  }
  return best;
}

}  // namespace batten::internal
