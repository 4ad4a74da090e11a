// SPDX-License-Identifier: MIT
#include "fitting/linear/banded_lu.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace batten::internal {

BandedLu::BandedLu(Eigen::Index size, Eigen::Index below, Eigen::Index above)
    : size_(size),
      below_(std::min(below, size - 1)),
      above_(std::min(above, size - 1)),
      stride_(2 * below_ + above_ + 1),
      data_(static_cast<size_t>(size * stride_), 0.0),
      pivots_(static_cast<size_t>(size)) {}

Eigen::Index BandedLu::Factor(double least) {
  Eigen::Index reach = 0;  // the last column that the rows in work touch
  for (Eigen::Index j = 0; j < size_; ++j) {
    const Eigen::Index last = std::min(size_ - 1, j + below_);
    Eigen::Index pivot = j;
    for (Eigen::Index i = j + 1; i <= last; ++i) {
      if (std::abs(*Data(i, j)) > std::abs(*Data(pivot, j))) pivot = i;
    }
    if (!(std::abs(*Data(pivot, j)) > least)) return j;
    pivots_[static_cast<size_t>(j)] = pivot;
    reach = std::max(reach, std::min(size_ - 1, pivot + above_));
    if (pivot != j) {
      for (Eigen::Index c = j; c <= reach; ++c) std::swap(*Data(pivot, c), *Data(j, c));
    }
    double* factors = Data(j, j);
    for (Eigen::Index i = 1; i <= last - j; ++i) factors[i] /= factors[0];
    for (Eigen::Index c = j + 1; c <= reach; ++c) {
      double* column = Data(j, c);
      for (Eigen::Index i = 1; i <= last - j; ++i) column[i] -= factors[i] * column[0];
    }
  }
  return size_;
}

void BandedLu::Solve(RightSides& rhs) const {
  for (Eigen::Index j = 0; j < size_; ++j) {
    const Eigen::Index pivot = pivots_[static_cast<size_t>(j)];
    if (pivot != j) rhs.row(j).swap(rhs.row(pivot));
    const double* factors = Data(j, j);
    const Eigen::Index count = std::min(size_ - 1 - j, below_);
    for (Eigen::Index i = 1; i <= count; ++i) rhs.row(j + i) -= factors[i] * rhs.row(j);
  }
  for (Eigen::Index j = size_ - 1; j >= 0; --j) {
    const double* column = Data(j, j);
    rhs.row(j) /= column[0];
    const Eigen::Index count = std::min(j, below_ + above_);
    for (Eigen::Index i = 1; i <= count; ++i) rhs.row(j - i) -= column[-i] * rhs.row(j);
  }
}

}  // namespace batten::internal
