// SPDX-License-Identifier: MIT
// A basis no finer than the tangent planes along an edge need.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "fitting/constraints/edge_rows.h"

namespace batten::internal {

// Where curves over the fine basis of an axis go: to a coarser one.
struct ReducedEdgeBasis {
  SplineBasis basis;
  Eigen::SparseMatrix<double> raised;   // of the coarse functions
  Eigen::SparseMatrix<double> thinned;  // of splines over the fine basis: nearly the same ones
};

// A fine basis has to carry every product of a coarse function with a tangent field; those that the
// solution is made of are smoother. The least basis is refined where the tangent rows of the
// solution (`unknowns`: t) would leave their tangent planes by more than 6e-7 or their own
// amount by more than 1e-5; ten or a hundred times that where it would take more than 400 functions
// and six times the least basis'. Ends and end slopes stay. Without tangent fields: the fine basis.
ReducedEdgeBasis Thinned(const EdgeRows& edges, bool along_u, const Eigen::VectorXd& unknowns);

}  // namespace batten::internal
