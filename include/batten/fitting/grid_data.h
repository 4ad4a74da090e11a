// SPDX-License-Identifier: MIT
// Points that were measured in rows and columns.
#pragma once

#include <Eigen/Core>
#include <string>

#include "batten/fitting/point_mask.h"

namespace batten {

// Point (i, j) of `rows` × `columns` is column i·columns + j (j, the direction v, runs fastest), as
// in the control net of a surface. Everything is finite; what a missing cell holds does not matter.
struct PointNet {
  int rows = 0, columns = 0;
  Eigen::Matrix3Xd points;
  PointMask missing = {};  // empty: every cell has its point

  Eigen::Vector3d At(int i, int j) const { return points.col(Eigen::Index{i} * columns + j); }
  bool complete() const { return missing.size() == 0 || !missing.any(); }
};

// Throws std::invalid_argument, its sentence beginning with `what`, unless there are two rows and
// two columns at least, sizes agree and everything is finite.
void Check(const PointNet& net, const std::string& what);

// The same, and throws, with a sentence for the user, where cells are missing.
void RequireComplete(const PointNet& net, const std::string& what);

// The middle of the points' box: about it, places far from the origin lose nothing.
Eigen::Vector3d MiddleOf(const PointNet& net);

// Edges of a grid all of whose points are in one place, to 1e-12 of its size: poles.
struct CollapsedLines {
  bool first_row = false, last_row = false, first_column = false, last_column = false;

  bool any_row() const { return first_row || last_row; }
  bool any_column() const { return first_column || last_column; }
};
CollapsedLines CollapsedLinesOf(const PointNet& net);

// Makes those edges of a control net (size_u × size_v) that are to be poles exactly one point each.
void Collapse(const CollapsedLines& poles, int size_u, int size_v, Eigen::Matrix3Xd& control);

// Rows become columns: point (i, j) goes to (j, i).
PointNet Transposed(const PointNet& net);

}  // namespace batten
