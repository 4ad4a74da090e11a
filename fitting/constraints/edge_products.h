// SPDX-License-Identifier: MIT
// Products of coarse B-splines with the directions that span the tangent planes along an edge.
#pragma once

#include <Eigen/SparseCore>
#include <array>

#include "fitting/constraints/ready_edge.h"
#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// The coordinates of M_m·T (first three) and of M_m·E (last three), column m each, as splines over
// the fine basis by local projection; M are the coarse functions, T is the field of the edge and E
// the derivative of its curve by `speed`. Values and slopes at the ends are exact.
std::array<Eigen::SparseMatrix<double, Eigen::RowMajor>, 6> EdgeProducts(const SplineBasis& coarse,
                                                                         const SplineBasis& fine,
                                                                         const ReadyEdge& edge,
                                                                         double speed);

}  // namespace batten::internal
