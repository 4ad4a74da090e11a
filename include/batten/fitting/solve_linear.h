// SPDX-License-Identifier: MIT
// Linear solve of a spline least-squares problem at given parameters.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/fitting_problem.h"
#include "batten/geometry/thread_pool.h"

namespace batten {

struct LinearSolution {
  Eigen::MatrixXd coefficients;  // d × (n_u · n_v), v fastest, repeated ones too; curves: d × n
  double residual_squares = 0;   // Σ w |S − z|², to full accuracy even where it is tiny
  bool regularised = false;      // the matrix was singular: smoothing had to be raised
};

// Solves for the coefficients. The fairness energy determines coefficients over empty cells; where
// it does not suffice, the smoothing is raised tenfold at a time and `regularised` is set. O(m + n
// · min(n_u, n_v)²).
LinearSolution SolveLinear(const FittingProblem& problem, ThreadPool& pool);

}  // namespace batten
