// SPDX-License-Identifier: MIT
// Removal cost of each knot of a fitted curve.
#pragma once

#include <vector>

#include "batten/fitting/fitting_problem.h"

namespace batten::internal {

// Returns for every value in `knots` (inner knots or a periodic seam, of multiplicity one) by how
// much the weighted sum of squares, fairness included, would rise if it were removed and the rest
// solved anew: |aᵀc|² / aᵀA⁻¹a, aᵀc the jump of the p-th derivative there and A the matrix of the
// problem. `coefficients` (d × n) are the problem's solution. 0 where the data say nothing of it.
// O(m p² + k n p) for k knots. [Wald's test of a linear constraint; Seber & Lee 2003, §4.3]
std::vector<double> RemovalCosts(const FittingProblem& problem,
                                 const Eigen::MatrixXd& coefficients,
                                 const std::vector<double>& knots,
                                 ThreadPool& pool);

}  // namespace batten::internal
