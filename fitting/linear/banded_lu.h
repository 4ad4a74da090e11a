// SPDX-License-Identifier: MIT
// LU factorisation of square banded matrices that are not symmetric.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace batten::internal {

// Right-hand sides beside each other: what is told of one unknown is contiguous.
using RightSides = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// A square matrix that is zero more than `below` places below and `above` places above its
// diagonal, and its factors with row interchanges.
class BandedLu {
 public:
  BandedLu(Eigen::Index size, Eigen::Index below, Eigen::Index above);

  Eigen::Index size() const { return size_; }

  // An entry inside the band.
  double& at(Eigen::Index row, Eigen::Index column) { return *Data(row, column); }

  // Replaces the matrix by its factors. O(size·below·(below + above)). Returns the first column
  // whose pivot is not above `least`, or size(); then the factors are whole. The contents are
  // spoilt otherwise. [Golub & Van Loan 2013, §4.3.3]
  [[nodiscard]] Eigen::Index Factor(double least);

  // After Factor(): solves A·x = rhs in place, for every column.
  void Solve(RightSides& rhs) const;

 private:
  // Storage is column by column, with room for the fill-in of the interchanges on top.
  double* Data(Eigen::Index row, Eigen::Index column) {
    return data_.data() + column * stride_ + (below_ + above_ + row - column);
  }
  const double* Data(Eigen::Index row, Eigen::Index column) const {
    return data_.data() + column * stride_ + (below_ + above_ + row - column);
  }

  Eigen::Index size_, below_, above_, stride_;
  std::vector<double> data_;
  std::vector<Eigen::Index> pivots_;  // the row interchanged with each
};

}  // namespace batten::internal
