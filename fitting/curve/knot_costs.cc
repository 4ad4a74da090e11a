// SPDX-License-Identifier: MIT
#include "fitting/curve/knot_costs.h"

#include <algorithm>

#include "fitting/knots/knot_line_removal.h"
#include "fitting/least_squares/penalised_system.h"
#include "fitting/linear/coefficient_order.h"

namespace batten::internal {

std::vector<double> RemovalCosts(const FittingProblem& problem,
                                 const Eigen::MatrixXd& coefficients,
                                 const std::vector<double>& knots,
                                 ThreadPool& pool) {
  const SplineBasis& basis = problem.basis_u();
  const PenalisedSystem system(problem, pool);
  BlockBandedMatrix matrix = system.Matrix(problem.smoothing(), 1);
  std::vector<double> costs(knots.size(), 0.0);
  if (!matrix.Factor()) return costs;

  const std::vector<int> rows = CoefficientOrder(basis).Rows(basis);
  Eigen::MatrixXd net(problem.unknowns(), coefficients.rows());
  for (size_t i = 0; i < rows.size(); ++i) {
    net.row(rows[i]) = coefficients.col(static_cast<Eigen::Index>(i)).transpose();
  }
  constexpr size_t kAtOnce = 64;
  for (size_t begin = 0; begin < knots.size(); begin += kAtOnce) {
    const size_t count = std::min(kAtOnce, knots.size() - begin);
    Eigen::MatrixXd jumps(problem.unknowns(), static_cast<Eigen::Index>(count));
    for (size_t k = 0; k < count; ++k) {
      jumps.col(static_cast<Eigen::Index>(k)) = TopDerivativeJump(basis, rows, knots[begin + k]);
    }
    Eigen::MatrixXd solved = jumps;
    matrix.Solve(solved);
    for (size_t k = 0; k < count; ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      const double spread = jumps.col(column).dot(solved.col(column));
      const double squares = (net.transpose() * jumps.col(column)).squaredNorm();
      costs[begin + k] = spread > 0 ? squares / spread : 0;
    }
  }
  return costs;
}

}  // namespace batten::internal
