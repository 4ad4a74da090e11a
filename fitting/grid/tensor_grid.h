// SPDX-License-Identifier: MIT
// Detects whether given parameters form a tensor-product grid.
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
  PointMask missing;                // cells without a point; empty: none
};

// The grid that parameters (2 × m) form: pairs of few different u and few different v, each pair at
// most once, with no more than `most_missing` of all pairs without a point. Values are different
// where they differ at all. Returns none where the parameters form no such grid, or where a
// direction has fewer than two values. O(m log m).
std::optional<GridOrder> FindTensorGrid(const Eigen::Matrix2Xd& parameters,
                                        double most_missing = 0.3);

}  // namespace batten::internal
