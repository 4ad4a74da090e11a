// SPDX-License-Identifier: MIT
#include "fitting/linear/tensor_band.h"

#include <algorithm>
#include <cstdlib>

namespace batten::internal {
namespace {

// y += B·x for the symmetric inner band whose entry {j, j+b} is at band[j·(q+1) + b].
void AddInner(const double* band, int m, int q, const double* x, double* y) {
  for (int j = 0; j < m; ++j, band += q + 1) {
    double sum = band[0] * x[j];
    const int last = std::min(q, m - 1 - j);
    for (int b = 1; b <= last; ++b) {
      sum += band[b] * x[j + b];
      y[j + b] += band[b] * x[j];
    }
    y[j] += sum;
  }
}

}  // namespace

TensorBand::TensorBand(int outer_size, int inner_size, int outer_reach, int inner_reach)
    : n_(outer_size), m_(inner_size), p_(outer_reach), q_(inner_reach) {
  numbers_.assign(static_cast<std::size_t>(RowAt(n_, 0)), 0.0);
}

void TensorBand::AddToDiagonal(double value) {
  for (int i = 0; i < n_; ++i) {
    for (int j = 0; j < m_; ++j) row(i, 0)[j * (q_ + 1)] += value;
  }
}

void TensorBand::AddTo(BlockBandedMatrix& matrix,
                       const std::vector<int>& outer_rows,
                       const std::vector<int>& inner_rows) const {
  for (int i = 0; i < n_; ++i) {
    for (int a = 0; a <= p_ && i + a < n_; ++a) {
      const double* band = row(i, a);
      // Two functions of one coefficient meet on the diagonal, from either side.
      const int row1 = outer_rows[static_cast<size_t>(i)],
                row2 = outer_rows[static_cast<size_t>(i + a)];
      const double times = row1 == row2 && a > 0 ? 2 : 1;
      auto block = matrix.at(std::max(row1, row2), std::abs(row2 - row1));
      for (int j = 0; j < m_; ++j) {
        const double* pair = band + j * (q_ + 1);
        const int column = inner_rows[static_cast<size_t>(j)];
        block(column, column) += times * pair[0];
        for (int b = 1; b <= q_ && j + b < m_; ++b) {
          const int column2 = inner_rows[static_cast<size_t>(j + b)];
          block(column2, column) += times * pair[b];
          block(column, column2) += times * pair[b];
        }
      }
    }
  }
}

Eigen::MatrixXd TensorBand::Times(const Eigen::MatrixXd& x, ThreadPool& pool) const {
  constexpr std::ptrdiff_t kRows = 8;
  Eigen::MatrixXd y = Eigen::MatrixXd::Zero(x.rows(), x.cols());
  pool.For(n_, kRows, [&](std::ptrdiff_t first, std::ptrdiff_t last) {
    for (Eigen::Index d = 0; d < x.cols(); ++d) {
      for (auto i = static_cast<int>(first); i < last; ++i) {
        for (int k = std::max(0, i - p_); k <= std::min(n_ - 1, i + p_); ++k)
          AddInner(row(std::min(i, k), std::abs(i - k)),
                   m_,
                   q_,
                   x.col(d).data() + std::ptrdiff_t{k} * m_,
                   y.col(d).data() + std::ptrdiff_t{i} * m_);
      }
    }
  });
  return y;
}

BlockBandedMatrix TensorBand::Of(const NetBox& box) const {
  BlockBandedMatrix matrix(box.outer_size(), box.inner_size(), std::min(p_, box.outer_size() - 1));
  for (int k = 0; k < box.outer_size(); ++k) {
    for (int below = 0; below <= std::min(matrix.bandwidth(), k); ++below) {
      auto block = matrix.at(k, below);
      const double* band = row(box.outer + k - below, below);
      for (int j = 0; j < box.inner_size(); ++j) {
        const double* pair = band + std::ptrdiff_t{box.inner + j} * (q_ + 1);
        block(j, j) = pair[0];
        for (int b = 1; b <= std::min(q_, box.inner_size() - 1 - j); ++b)
          block(j + b, j) = block(j, j + b) = pair[b];
      }
    }
  }
  return matrix;
}

}  // namespace batten::internal
