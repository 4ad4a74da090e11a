// SPDX-License-Identifier: MIT
// The symmetric matrix of a tensor-product spline problem, and its Cholesky factorisation.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/thread_pool.h"

namespace batten::internal {

struct BandColumns;

// A symmetric positive definite matrix of `blocks` × `blocks` square blocks of size `block_size`,
// zero beyond `bandwidth` blocks off the diagonal; only the lower half is stored. With the longer
// direction of a control net outside, a degree-p problem has bandwidth p.
class BlockBandedMatrix {
 public:
  using Block = Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
  using ConstBlock = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

  BlockBandedMatrix(int blocks, int block_size, int bandwidth);

  int blocks() const { return blocks_; }
  int block_size() const { return block_size_; }
  int bandwidth() const { return bandwidth_; }
  int size() const { return blocks_ * block_size_; }

  // Block (row, row − below), 0 ≤ below ≤ bandwidth, below ≤ row; diagonal blocks hold both
  // triangles. Blocks of one column stand below each other, `stride()` from column to column.
  // Throws std::invalid_argument where there is no such block.
  Block at(int row, int below) {
    RequireBlock(row, below);
    return {data_.data() + Offset(row, below),
            block_size_,
            block_size_,
            Eigen::OuterStride<>(stride())};
  }
  ConstBlock at(int row, int below) const {
    RequireBlock(row, below);
    return {data_.data() + Offset(row, below),
            block_size_,
            block_size_,
            Eigen::OuterStride<>(stride())};
  }
  Eigen::Index stride() const { return (Eigen::Index{bandwidth_} + 1) * block_size_; }

  double Trace() const;
  void AddToDiagonal(double value);

  // Replaces rows and columns by those of the identity times `pivot`.
  void Pin(const std::vector<Eigen::Index>& rows, double pivot);

  // A·x, before Factor(). O(blocks · bandwidth · block_size²) a column.
  Eigen::MatrixXd Times(const Eigen::MatrixXd& x) const;

  // Replaces the matrix by its Cholesky factor L, A = L·Lᵀ. Returns whether the matrix was positive
  // definite; if not, the contents are spoilt. Threads, where given, work on large matrices and do
  // not change the result by one bit. Not from inside pool->For. O(n w²) with half a scalar
  // bandwidth w: what is zero at the edge of the band is left out. [Golub & Van Loan 2013, §4.2,
  // §4.3]
  [[nodiscard]] bool Factor(ThreadPool* pool = nullptr);

  // After Factor(): the least squared diagonal entry of L. The matrix is singular where this is not
  // above the rounding of its own diagonal.
  double SmallestPivot() const;

  // After Factor(): solves A·x = rhs in place, for every column. Columns do not change each other's
  // results.
  void Solve(Eigen::MatrixXd& rhs) const;

  // The two halves of Solve(): L⁻¹·rhs and L⁻ᵀ·rhs in place.
  void Forward(Eigen::MatrixXd& rhs) const;
  void Backward(Eigen::MatrixXd& rhs) const;

 private:
  Eigen::Index Offset(int row, int below) const {
    return ((row - below) * stride() + below) * block_size_;
  }
  void RequireBlock(int row, int below) const {
    if (below < 0 || below > bandwidth_ || row < below || row >= blocks_) RejectBlock(row, below);
  }
  [[noreturn]] void RejectBlock(int row, int below) const;
  BandColumns Columns() const;
  void Sweep(Eigen::MatrixXd& rhs, bool forward, bool backward) const;

  int blocks_, block_size_, bandwidth_;
  std::vector<double> data_;
  std::vector<int> ends_;  // after Factor(): one past each column's last row
};

}  // namespace batten::internal
