// SPDX-License-Identifier: MIT
// Splines over some of the knots of a finer basis.
#pragma once

#include <Eigen/SparseCore>

#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// Clamped bases on one domain, all knots of the coarse one among those of the fine one:
// coefficients of the fine one are this matrix (fine × coarse, rows that are not negative and sum
// to one) times those of the coarse one. [Cohen, Lyche & Riesenfeld 1980, the Oslo algorithm]
Eigen::SparseMatrix<double, Eigen::RowMajor> KnotInsertion(const SplineBasis& coarse,
                                                           const SplineBasis& fine);

// The clamped basis over every `step`-th inner knot of a clamped one.
SplineBasis EveryKnot(const SplineBasis& fine, int step);

}  // namespace batten::internal
