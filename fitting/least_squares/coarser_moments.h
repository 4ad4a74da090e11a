// SPDX-License-Identifier: MIT
// Moments over coarser cells, and what they tell of a surface, without the points.
#pragma once

#include <Eigen/Core>

#include "batten/geometry/spline_basis.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/least_squares/cell_moments.h"

namespace batten::internal {

// The moments over the spans of coarser bases, whose knots are all among those of the fine bases:
// what CellMoments of the points would be, to rounding, as the products of a cell are products of
// its parts times positive factors.
CellMoments CoarserMoments(const CellMoments& fine,
                           const SplineBasis& fine_outer,
                           const SplineBasis& fine_inner,
                           const SplineBasis& outer,
                           const SplineBasis& inner,
                           ThreadPool& pool);

// Of every cell (outer × inner spans) the weights of its points, and the sum Σ w |S − z|² of a net
// (size × d, inner index fastest). The sum is a difference: right to some 1e-14 of Σ w |z|², and
// never negative.
struct CellErrors {
  Eigen::ArrayXXd weights, squares;
};
CellErrors ErrorsOfCells(const CellMoments& moments,
                         const SplineBasis& outer,
                         const SplineBasis& inner,
                         const Eigen::MatrixXd& net,
                         ThreadPool& pool);

}  // namespace batten::internal
