// SPDX-License-Identifier: MIT
// The symmetric matrix of a tensor-product spline problem, and its Cholesky factorisation.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace batten {

// A symmetric positive definite matrix of `blocks` × `blocks` square blocks of size `block_size`,
// zero beyond `bandwidth` blocks off the diagonal; only the lower half is stored. With the longer
// direction of a control net outside, a degree-p problem has bandwidth p.
class BlockBandedMatrix {
 public:
  using Block = Eigen::Map<Eigen::MatrixXd>;
  using ConstBlock = Eigen::Map<const Eigen::MatrixXd>;

  BlockBandedMatrix(int blocks, int block_size, int bandwidth);

  int blocks() const { return blocks_; }
  int block_size() const { return block_size_; }
  int bandwidth() const { return bandwidth_; }
  int size() const { return blocks_ * block_size_; }

  // Block (row, row − below), 0 ≤ below ≤ bandwidth; diagonal blocks hold both triangles.
  Block at(int row, int below) { return {Data(row, below), block_size_, block_size_}; }
  ConstBlock at(int row, int below) const { return {Data(row, below), block_size_, block_size_}; }

  double Trace() const;
  void AddToDiagonal(double value);

  // A·x, before Factor(). O(blocks · bandwidth · block_size²) a column.
  Eigen::MatrixXd Times(const Eigen::MatrixXd& x) const;

  // Replaces the matrix by its Cholesky factor L, A = L·Lᵀ. Returns whether the matrix was positive
  // definite; if not, the contents are spoilt. O(blocks · bandwidth² · block_size³).
  [[nodiscard]] bool Factor();

  // After Factor(): the least squared diagonal entry of L. What is not above the rounding of the
  // matrix' own diagonal says that it is singular.
  double SmallestPivot() const;

  // After Factor(): solves A·x = rhs in place, for every column.
  void Solve(Eigen::MatrixXd& rhs) const;

 private:
  double* Data(int row, int below) {
    return data_.data() +
           (static_cast<size_t>(row) * (bandwidth_ + 1) + below) * block_size_ * block_size_;
  }
  const double* Data(int row, int below) const {
    return data_.data() +
           (static_cast<size_t>(row) * (bandwidth_ + 1) + below) * block_size_ * block_size_;
  }

  int blocks_, block_size_, bandwidth_;
  std::vector<double> data_;
};

}  // namespace batten
