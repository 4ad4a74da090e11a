// SPDX-License-Identifier: MIT
#include "batten/fitting/block_banded_matrix.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

namespace batten {

BlockBandedMatrix::BlockBandedMatrix(int blocks, int block_size, int bandwidth)
    : blocks_(blocks), block_size_(block_size), bandwidth_(bandwidth) {
  if (blocks < 1 || block_size < 1 || bandwidth < 0) {
    throw std::invalid_argument("BlockBandedMatrix: sizes must be positive");
  }
  data_.assign(static_cast<size_t>(blocks) * (bandwidth + 1) * block_size * block_size, 0.0);
}

double BlockBandedMatrix::Trace() const {
  double trace = 0;
  for (int k = 0; k < blocks_; ++k) trace += at(k, 0).trace();
  return trace;
}

void BlockBandedMatrix::AddToDiagonal(double value) {
  for (int k = 0; k < blocks_; ++k) at(k, 0).diagonal().array() += value;
}

Eigen::MatrixXd BlockBandedMatrix::Times(const Eigen::MatrixXd& x) const {
  const int b = block_size_;
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(x.rows(), x.cols());
  for (int row = 0; row < blocks_; ++row) {
    for (int below = 0; below <= std::min(bandwidth_, row); ++below) {
      const auto block = at(row, below);
      const int column = row - below;
      result.middleRows(row * b, b).noalias() += block * x.middleRows(column * b, b);
      if (below > 0)
        result.middleRows(column * b, b).noalias() += block.transpose() * x.middleRows(row * b, b);
    }
  }
  return result;
}

// Left-looking by block rows: row k of L from the rows above it inside the band.
bool BlockBandedMatrix::Factor() {
  for (int k = 0; k < blocks_; ++k) {
    const int reach = std::min(bandwidth_, k);
    for (int below = reach; below >= 0; --below) {
      const int column = k - below;
      Block target = at(k, below);
      // Σ over earlier columns j of L(k,j)·L(column,j)ᵀ.
      for (int j = std::max(0, k - bandwidth_); j < column; ++j) {
        if (column - j > bandwidth_) continue;
        const Block a = at(k, k - j), b = at(column, column - j);
        if (below == 0) {
          target.selfadjointView<Eigen::Lower>().rankUpdate(a, -1.0);
        } else {
          target.noalias() -= a * b.transpose();
        }
      }
      if (below > 0) {
        const auto diagonal = std::as_const(*this).at(column, 0);
        diagonal.transpose().triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(target);
      } else {
        Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(target);
        if (factor.info() != Eigen::Success) return false;
      }
    }
  }
  return true;
}

double BlockBandedMatrix::SmallestPivot() const {
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < blocks_; ++k)
    least = std::min(least, at(k, 0).diagonal().cwiseAbs2().minCoeff());
  return least;
}

void BlockBandedMatrix::Solve(Eigen::MatrixXd& rhs) const {
  const int b = block_size_;
  for (int k = 0; k < blocks_; ++k) {
    for (int below = 1; below <= std::min(bandwidth_, k); ++below) {
      rhs.middleRows(k * b, b).noalias() -= at(k, below) * rhs.middleRows((k - below) * b, b);
    }
    at(k, 0).triangularView<Eigen::Lower>().solveInPlace(rhs.middleRows(k * b, b));
  }
  for (int k = blocks_ - 1; k >= 0; --k) {
    for (int below = 1; below <= bandwidth_ && k + below < blocks_; ++below) {
      rhs.middleRows(k * b, b).noalias() -=
          at(k + below, below).transpose() * rhs.middleRows((k + below) * b, b);
    }
    at(k, 0).transpose().triangularView<Eigen::Upper>().solveInPlace(rhs.middleRows(k * b, b));
  }
}

}  // namespace batten
