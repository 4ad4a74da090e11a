// SPDX-License-Identifier: MIT
// Selects linearly independent rows from linear conditions, some of which may follow from, or
// contradict, others.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace batten::internal {

// The equations of C x = c that do not depend on earlier ones, as L Q x = c with orthonormal rows Q
// and L lower triangular.
class IndependentRows {
 public:
  // A row counts as dependent where what earlier rows leave of it is less than 1e-9 of its scale
  // (one number a row, > 0). O(rows² · columns). [Golub & Van Loan 2013, §5.2.8]
  IndependentRows(const Eigen::MatrixXd& rows, const Eigen::VectorXd& scales);

  const std::vector<Eigen::Index>& kept() const { return kept_; }

  // The x of least length with (rows that are kept) · x = `values`.
  Eigen::VectorXd LeastSolution(const Eigen::VectorXd& values) const;

 private:
  std::vector<Eigen::Index> kept_;
  Eigen::MatrixXd orthonormal_, triangle_;
};

}  // namespace batten::internal
