// SPDX-License-Identifier: MIT
// A symmetric matrix of tensor products, as few numbers as it has.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "batten/geometry/thread_pool.h"
#include "fitting/linear/block_banded_matrix.h"

namespace batten::internal {

// A range of rows of a net: outer [outer, outer_end), inner [inner, inner_end).
struct NetBox {
  int outer, outer_end, inner, inner_end;

  int outer_size() const { return outer_end - outer; }
  int inner_size() const { return inner_end - inner; }
  Eigen::Index size() const { return Eigen::Index{outer_size()} * inner_size(); }
};

// The matrix over a net of n × m coefficients, inner index fastest, whose entry of (i,j) and (k,l)
// depends on the unordered pairs {i,k} and {j,l} only and vanishes beyond p and q: a sum of
// products of a symmetric outer and a symmetric inner factor, such as normal matrices and energies
// of tensor-product splines, coefficients that repeat apart. (p+1)(q+1) numbers a coefficient.
class TensorBand {
 public:
  TensorBand(int outer_size, int inner_size, int outer_reach, int inner_reach);

  int outer_size() const { return n_; }
  int inner_size() const { return m_; }
  Eigen::Index size() const { return Eigen::Index{n_} * m_; }

  // The entry of {i, i+a} and {j, j+b}: at row(i, a)[j·(q+1) + b].
  double* row(int i, int a) { return numbers_.data() + RowAt(i, a); }
  const double* row(int i, int a) const { return numbers_.data() + RowAt(i, a); }
  std::ptrdiff_t row_size() const { return std::ptrdiff_t{m_} * (q_ + 1); }
  int outer_reach() const { return p_; }
  int inner_reach() const { return q_; }

  void AddToDiagonal(double value);

  // Adds the matrix to one whose rows stand for these outer and inner coefficients; those that
  // repeat stand for one.
  void AddTo(BlockBandedMatrix& matrix,
             const std::vector<int>& outer_rows,
             const std::vector<int>& inner_rows) const;

  // A·x, x of size() rows. The result does not depend on threads.
  Eigen::MatrixXd Times(const Eigen::MatrixXd& x, ThreadPool& pool) const;

  // The rows and columns of a box, the outer index outside.
  BlockBandedMatrix Of(const NetBox& box) const;

 private:
  std::ptrdiff_t RowAt(int i, int a) const {
    return (std::ptrdiff_t{i} * (p_ + 1) + a) * row_size();
  }

  int n_, m_, p_, q_;
  std::vector<double> numbers_;
};

}  // namespace batten::internal
