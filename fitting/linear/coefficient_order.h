// SPDX-License-Identifier: MIT
// The distinct coefficients of a (periodic) spline basis and their order in a banded solver.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// The number of distinct coefficients: a periodic basis of n functions has n − p, the last p
// repeat.
inline int DistinctCount(const SplineBasis& basis) {
  return basis.periodic() ? basis.size() - basis.degree() : basis.size();
}

// The index of coefficient i among the distinct ones.
inline int DistinctIndex(const SplineBasis& basis, int i) {
  return basis.periodic() ? i % DistinctCount(basis) : i;
}

// DistinctIndex of every coefficient; {0} for no basis (null).
inline std::vector<int> DistinctIndices(const SplineBasis* basis) {
  std::vector<int> indices(basis ? static_cast<size_t>(basis->size()) : 1, 0);
  for (size_t i = 0; basis && i < indices.size(); ++i) {
    indices[i] = DistinctIndex(*basis, static_cast<int>(i));
  }
  return indices;
}

// The place of i in a ring of m that is dealt out from both ends in turn, 0, m − 1, 1, m − 2, …:
// neighbours in the ring stay within two places.
inline Eigen::Index DealtPlace(Eigen::Index i, Eigen::Index m) {
  return 2 * i < m ? 2 * i : 2 * (m - 1 - i) + 1;
}

// Order of the rows of the normal matrix. Around a periodic basis every function overlaps the p
// before and behind it; dealt out from both ends they stay within 2p rows, and the matrix remains a
// band.
class CoefficientOrder {
 public:
  explicit CoefficientOrder(const SplineBasis& basis)
      : count_(DistinctCount(basis)), degree_(basis.degree()), around_(basis.periodic()) {}

  int count() const { return count_; }
  int bandwidth() const { return std::min(count_ - 1, around_ ? 2 * degree_ : degree_); }

  // The row of each coefficient of the basis.
  std::vector<int> Rows(const SplineBasis& basis) const {
    std::vector<int> rows(static_cast<size_t>(basis.size()));
    for (int i = 0; i < basis.size(); ++i) rows[static_cast<size_t>(i)] = Row(i);
    return rows;
  }

 private:
  int Row(int i) const { return around_ ? static_cast<int>(DealtPlace(i % count_, count_)) : i; }

  int count_, degree_;
  bool around_;
};

}  // namespace batten::internal
