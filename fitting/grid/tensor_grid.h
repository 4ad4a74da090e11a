// SPDX-License-Identifier: MIT
// Whether given parameters are those of a grid.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "batten/fitting/point_mask.h"

namespace batten::internal {

// A cloud's points as the cells of a grid.
struct GridOrder {
  int rows = 0, columns = 0;
  Eigen::VectorXd u, v;             // of the rows and columns, increasing
  std::vector<Eigen::Index> order;  // points, row after row, cells that are missing left out
  PointMask missing;                // cells; empty: none
};

// The grid that parameters (2 × m) form: where they are pairs of few different u and few different
// v, each pair at most once, and no more than `most_missing` of all pairs are without a point.
// Values are different where they differ at all. None where they are not, or where a direction has
// fewer than two values. O(m log m).
std::optional<GridOrder> FindTensorGrid(const Eigen::Matrix2Xd& parameters,
                                        double most_missing = 0.3);

}  // namespace batten::internal
