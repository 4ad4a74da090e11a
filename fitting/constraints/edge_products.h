// SPDX-License-Identifier: MIT
// What a tangent row is made of: coarse functions times the directions that span tangent planes.
#pragma once

#include <Eigen/SparseCore>
#include <array>

#include "fitting/constraints/ready_edge.h"
#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// The coordinates of M_m·T (first three) and of M_m·E (last three), column m each, M the coarse
// functions, T the field of the edge and E the derivative of its curve by `speed`, as splines over
// the fine basis: their local projections. Values and slopes at the ends are right.
std::array<Eigen::SparseMatrix<double, Eigen::RowMajor>, 6> EdgeProducts(const SplineBasis& coarse,
                                                                         const SplineBasis& fine,
                                                                         const ReadyEdge& edge,
                                                                         double speed);

}  // namespace batten::internal
