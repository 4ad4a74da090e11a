// SPDX-License-Identifier: MIT
// Reduction of an edge's fine basis to the knots its tangent planes need.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "fitting/constraints/edge_rows.h"

namespace batten::internal {

// A coarser basis for curves over the fine basis of an axis, with the conversion matrices.
struct ReducedEdgeBasis {
  SplineBasis basis;
  Eigen::SparseMatrix<double> raised;   // coarse functions over this basis
  Eigen::SparseMatrix<double> thinned;  // projects splines over the fine basis
};

// Refines the least basis where the tangent rows of the solution (`unknowns`: t) would deviate from
// their tangent planes by more than 6e-7 or from their own amount by more than 1e-5; ten or a
// hundred times that where it would need more than 400 functions and six times those of the least
// basis. The fine basis represents every product of a coarse function with a tangent field; the
// products in the solution are smoother and need fewer knots. Ends and end slopes stay. Without
// tangent fields the result is the fine basis.
ReducedEdgeBasis Thinned(const EdgeRows& edges, bool along_u, const Eigen::VectorXd& unknowns);

}  // namespace batten::internal
