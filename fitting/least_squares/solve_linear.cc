// SPDX-License-Identifier: MIT
#include "batten/fitting/solve_linear.h"

#include "fitting/least_squares/penalised_system.h"

namespace batten {
using namespace internal;
namespace {

// Share of the sum of squares below which cancellation leaves no digits; the residual is then
// summed point by point.
constexpr double kCancelled = 1e-9;

}  // namespace

LinearSolution SolveLinear(const FittingProblem& problem, ThreadPool& pool) {
  const PenalisedSystem system(problem, pool);
  const PenalisedSystem::Solution solution = system.Solve(problem.smoothing(), &pool);
  LinearSolution result;
  result.coefficients = system.Net(solution.rows);
  result.regularised = solution.raised;
  result.residual_squares = solution.residual_squares;
  if (result.residual_squares < kCancelled * system.squares()) {
    const Eigen::VectorXd errors =
        (EvaluateAt(problem, result.coefficients, pool) - problem.data().values)
            .colwise()
            .squaredNorm();
    const Eigen::VectorXd& weights = problem.data().weights;
    result.residual_squares = weights.size() > 0 ? weights.dot(errors) : errors.sum();
  }
  return result;
}

}  // namespace batten
