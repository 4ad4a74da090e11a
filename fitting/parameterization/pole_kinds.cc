// SPDX-License-Identifier: MIT
#include "fitting/parameterization/pole_kinds.h"

#include <algorithm>
#include <cmath>

#include "batten/fitting/solve_linear.h"
#include "fitting/core/rounding.h"
#include "fitting/core/shared_constants.h"
#include "fitting/least_squares/fitting_bases.h"
#include "fitting/linear/coefficient_order.h"

namespace batten::internal {
namespace {

constexpr double kBeyondChance = 30;  // variances: three more unknowns take away three by chance
constexpr double kSlopeOfApex = 0.15;

// Slope of the cone about the axis at a pole: distance of the second row's centre from the pole
// divided by its radius.
double SlopeAt(const FittingProblem& problem, const Eigen::MatrixXd& net, bool start) {
  const SplineBasis& basis = problem.basis_u();
  const int size_v = problem.basis_v().size(), m = DistinctCount(basis);
  const int edge = start ? 0 : size_v - 1, next = start ? 1 : size_v - 2;
  const Eigen::Vector3d pole = net.col(edge);
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (int i = 0; i < m; ++i) middle += net.col(i * size_v + next) / m;
  double squares = 0;
  for (int i = 0; i < m; ++i) squares += (net.col(i * size_v + next) - middle).squaredNorm() / m;
  return squares > 0 ? (middle - pole).norm() / std::sqrt(squares) : 0;
}

}  // namespace

Poles PolesByData(const Parameterization& base,
                  const PointCloud& points,
                  const PointMask& mask,
                  const BaseScore::Value& grid,
                  ThreadPool& pool) {
  Poles poles = base.poles;
  const FittingProblem one_cell =
      base.ProblemOf(points, mask, kProbeDegree, kProbeDegree, kSurfaceSmoothing);
  const FittingProblem problem = OverCells(one_cell, grid.cells_u, grid.cells_v);
  const double smooth = SolveLinear(problem, pool).residual_squares;
  for (const bool start : {true, false}) {
    PoleKind& kind = start ? poles.start : poles.end;
    if (kind == PoleKind::kNone) continue;
    Poles trial = base.poles;
    (start ? trial.start : trial.end) = PoleKind::kApex;
    const FittingProblem with_apex = problem.WithPoles(trial);
    const LinearSolution apex = SolveLinear(with_apex, pool);
    const auto numbers = static_cast<double>(3 * problem.size());
    const double variance = apex.residual_squares / std::max(1.0, numbers);
    const bool pays = smooth - apex.residual_squares > kBeyondChance * variance;
    kind = pays && SlopeAt(with_apex, apex.coefficients, start) > kSlopeOfApex ? PoleKind::kApex
                                                                               : PoleKind::kSmooth;
  }
  return poles;
}

}  // namespace batten::internal
