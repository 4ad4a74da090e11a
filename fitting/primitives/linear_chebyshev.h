// SPDX-License-Identifier: MIT
// Linear Chebyshev approximation: the least greatest absolute residual.
#pragma once

#include <Eigen/Core>

namespace batten::internal {

struct ChebyshevSolution {
  Eigen::VectorXd x;
  double greatest = 0;  // max |r + J x|
  bool solved = false;  // to rounding; else the best found
};

// Minimises max_k |r_k + J_k x| over x ∈ R^n, m > n residuals: the dual simplex method, which keeps
// a reference of n + 1 points that determine the optimum among themselves and exchanges one of them
// for the point farthest off. J must have full rank. [Stiefel 1959; Watson 1980, §2.5]
ChebyshevSolution SolveChebyshev(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residuals);

}  // namespace batten::internal
