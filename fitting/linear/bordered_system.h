// SPDX-License-Identifier: MIT
// Symmetric systems of three coordinates that share a banded matrix, coupled by a border, under
// linear conditions.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "fitting/linear/block_banded_matrix.h"

namespace batten::internal {

// Minimises  Σ_d (x_dᵀ A x_d / 2 + x_dᵀ B_d t − x_dᵀ f_d) + tᵀ D t / 2 − tᵀ g  over x_0, x_1, x_2
// and t under conditions  direction_k · (φ_kᵀ x_0, φ_kᵀ x_1, φ_kᵀ x_2) + c_kᵀ t = h_k, φ_k column
// functional[k] of `functionals` (none: −1).
struct BorderedSystem {
  std::array<Eigen::MatrixXd, 3> border;  // B_d: n × t
  Eigen::MatrixXd corner;                 // D
  Eigen::MatrixXd right;                  // f_d: n × 3
  Eigen::VectorXd corner_right;           // g
  Eigen::MatrixXd functionals;            // n × functionals
  std::vector<int> functional;
  Eigen::Matrix3Xd directions;
  Eigen::MatrixXd condition_rows;  // c_k: conditions × t
  Eigen::VectorXd condition_right;
};

struct BorderedSolution {
  Eigen::MatrixXd inner;  // n × 3
  Eigen::VectorXd border;
};

// Solves by block elimination, A given by its factor; conditions, which must be independent, enter
// by Lagrange multipliers. O(solutions with A: 3 t + functionals).
BorderedSolution Solve(const BorderedSystem& system, const BlockBandedMatrix& factor);

}  // namespace batten::internal
