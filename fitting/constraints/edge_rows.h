// SPDX-License-Identifier: MIT
// The part of a constrained surface determined by its edges: rows and columns of curves.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <string>
#include <vector>

#include "fitting/constraints/refined_edge_basis.h"

namespace batten::internal {

// With M_i and N_j the coarse functions of u and v, I and J those that the edges take over (the
// outermost, and the next where a tangent field is given), the surface is
//   S = Σ_{j∈J} N_j(v) r̃_j(u) + Σ_{i∈I} M_i(u) l_i(v) + Σ_{i∉I, j∉J} M_i(u) N_j(v) x_ij,
//   r̃_j = r_j − Σ_{i∈I} M_i · (coefficient i of r_j).
// l_0 and r_0 are edge curves; the next ones are r_1 = r_0 ± (a T + b E) with scalar splines a and
// b over the coarse functions, whose coefficients t are unknown: linear in t. The surface has the
// edges exactly, and the fields where the coefficients of r_j and l_i that stand for one another at
// a corner are the same: conditions on t. [Coons 1967; Gordon 1969]

// One row (or column) of the net: a curve over the fine basis along it, times one coarse function
// across it.
struct EdgeRow {
  bool along_u;
  int edge;     // its index among the edges
  int profile;  // the coarse function of the other direction
  int first;    // index of its first unknown
  int count;    // number of unknowns; zero for a given row
  // For each coordinate, size of the fine basis × (count + 1): a column for each unknown, the last
  // one for the given part.
  std::array<Eigen::SparseMatrix<double, Eigen::RowMajor>, 3> curves;
};

// Three equations g + G t = 0 at a corner: the first two in the edges' common tangent plane, the
// third across it.
struct CornerCondition {
  std::string name;
  Eigen::MatrixXd unknowns;  // 3 × count
  Eigen::Vector3d given;
  double length = 0;  // scale by which the third is the sine of an angle; 0: a length
};

struct EdgeRows {
  RefinedEdgeBasis u, v;
  std::vector<ReadyEdge> edges;
  std::vector<EdgeRow> rows;
  std::vector<CornerCondition> corners;
  int unknowns = 0;                    // t, all of them lengths
  std::vector<char> taken_u, taken_v;  // I and J, by coarse function
};

// Builds the rows, with coordinates about the centre. Edges whose ends at a corner are less than
// 1e-9 of the edges' size apart meet in the middle. Throws std::invalid_argument, naming the edges,
// where they are further apart, an edge is given twice, a basis is not clamped, or has too few
// functions for the conditions.
EdgeRows EdgeRowsOf(const SplineBasis& basis_u,
                    const SplineBasis& basis_v,
                    const std::vector<FixedEdge>& edges,
                    const Eigen::Vector3d& centre);

}  // namespace batten::internal
