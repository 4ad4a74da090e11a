// SPDX-License-Identifier: MIT
#include "fitting/curve/knot_costs.h"

#include <algorithm>

#include "fitting/linear/coefficient_order.h"
#include "fitting/least_squares/penalised_system.h"

namespace batten::internal {
namespace {

// The span that begins at a knot of the domain.
int SpanFrom(const SplineBasis& basis, double knot) { return basis.Span(knot); }

// The span that ends there; around a periodic basis, at the seam, the last one.
int SpanTo(const SplineBasis& basis, double knot) {
  if (knot <= basis.lower()) return basis.Span(basis.upper());
  int span = basis.Span(knot) - 1;
  while (basis.knots()[static_cast<size_t>(span)] == basis.knots()[static_cast<size_t>(span) + 1]) {
    --span;
  }
  return span;
}

// Adds factor times the p-th derivatives on a span, functions of the same coefficient together.
void AddTopDerivatives(const SplineBasis& basis,
                       const std::vector<int>& rows,
                       int span,
                       double factor,
                       Eigen::Ref<Eigen::VectorXd> jump) {
  const int p = basis.degree();
  std::vector<double> values(static_cast<size_t>((p + 1) * (p + 1)));
  const double low = basis.knots()[static_cast<size_t>(span)],
               high = basis.knots()[static_cast<size_t>(span) + 1];
  basis.Derivatives(span, low + (high - low) / 2, p, values.data());
  for (int r = 0; r <= p; ++r) {
    jump[rows[static_cast<size_t>(span - p + r)]] +=
        factor * values[static_cast<size_t>(p * (p + 1) + r)];
  }
}

}  // namespace

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
    Eigen::MatrixXd jumps =
        Eigen::MatrixXd::Zero(problem.unknowns(), static_cast<Eigen::Index>(count));
    for (size_t k = 0; k < count; ++k) {
      const double knot = knots[begin + k];
      auto jump = jumps.col(static_cast<Eigen::Index>(k));
      AddTopDerivatives(basis, rows, SpanFrom(basis, knot), 1, jump);
      AddTopDerivatives(basis, rows, SpanTo(basis, knot), -1, jump);
      jump.stableNormalize();
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
