// SPDX-License-Identifier: MIT
#include "batten/fitting/solve_linear.h"

#include "fitting/core/rounding.h"
#include "fitting/least_squares/fitting_bases.h"
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
    result.residual_squares = SquaresOf(problem, result.coefficients, pool);
  }
  return result;
}

}  // namespace batten
