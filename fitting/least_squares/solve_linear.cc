// SPDX-License-Identifier: MIT
#include "batten/fitting/solve_linear.h"

#include "fitting/core/rounding.h"
#include "fitting/least_squares/penalised_system.h"

namespace batten {
using namespace internal;

LinearSolution SolveLinear(const FittingProblem& problem, ThreadPool& pool) {
  const PenalisedSystem system(problem, pool);
  const PenalisedSystem::Solution solution = system.Solve(problem.smoothing(), &pool);
  LinearSolution result;
  result.coefficients = system.Net(solution.rows);
  result.regularised = solution.raised;
  result.residual_squares = solution.residual_squares;
  // Below this share of the sum of squares, cancellation leaves no digits.
  if (result.residual_squares < kRelativelyEqual * system.squares()) {
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
