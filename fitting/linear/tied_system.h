// SPDX-License-Identifier: MIT
// Solves a block-banded system some of whose rows are tied to a few unknowns.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <optional>
#include <vector>

#include "batten/geometry/thread_pool.h"
#include "fitting/linear/block_banded_matrix.h"

namespace batten::internal {

// The ties x = Z (x_f, t) on the rows of a block-banded matrix: a range of rows in a range of
// blocks is free and unchanged; all other rows are tied, x_tied = forms · t.
struct NetTies {
  int first_block = 0, blocks = 0;  // of free rows
  int first_row = 0, rows = 0;      // inside each
  std::vector<Eigen::Index> tied;
  Eigen::MatrixXd forms;  // tied rows × unknowns t; orthonormal columns

  bool any() const { return !tied.empty(); }
};

// Minimises ½ xᵀMx − bᵀx over x = Zy. ZᵀMZ is a band of the free rows with a border as wide as t is
// long, and is factored as such. With few unknowns t that costs hardly more than M alone; Lagrange
// multipliers would cost a solve for every condition. [Golub & Van Loan 2013, §4.2, §4.3]
class TiedSystem {
 public:
  // M not factored, and positive semidefinite. Without ties nothing is copied. O(n w).
  TiedSystem(BlockBandedMatrix matrix, const NetTies& ties);

  // Factors ZᵀMZ = LLᵀ; returns whether it was positive definite. If not, the contents are spoilt.
  // Threads do not change the result; not from inside pool->For. O(n w² + n w k), k the unknowns t.
  [[nodiscard]] bool Factor(ThreadPool* pool = nullptr);

  // After Factor(): the least squared diagonal entry of L.
  double SmallestPivot() const;

  // After Factor(): x = Z (ZᵀMZ)⁻¹ Zᵀ rhs in place, for every column. O(n w) a column.
  void Solve(Eigen::MatrixXd& rhs) const;

 private:
  Eigen::Index FreeRow(Eigen::Index block, Eigen::Index row) const;
  void GatherFree(const BlockBandedMatrix& matrix);
  void GatherOutline(const BlockBandedMatrix& matrix);
  Eigen::MatrixXd Free(const Eigen::MatrixXd& rows) const;
  Eigen::MatrixXd Tied(const Eigen::MatrixXd& rows) const;

  NetTies ties_;
  int block_size_;
  std::optional<BlockBandedMatrix> inner_;  // of the free rows; none where all are tied
  Eigen::MatrixXd border_;                  // free rows × t, after Factor() times L⁻¹
  Eigen::MatrixXd corner_;                  // t × t
  std::optional<Eigen::LLT<Eigen::MatrixXd>> corner_factor_;  // after Factor(), with ties
};

}  // namespace batten::internal
