// SPDX-License-Identifier: MIT
// Eigen's decompositions of small dense matrices, compiled once: a unit that instantiates one of
// its own takes 3 to 9 s longer. Innermost loops take Eigen's, of fixed sizes.
#pragma once

#include <Eigen/Core>

namespace batten::internal {

// X of the least |A X − B|, by Householder's QR with pivots. The columns of A are independent:
// where they hardly are, X is rounding of any size, and where one is zero it may not be finite.
Eigen::MatrixXd LeastSquares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

// The smallest of all X of the least |A X − B|. A lacks rank where pivots of its QR are below
// `threshold` of the greatest. [Golub & Van Loan 2013, §5.5]
Eigen::MatrixXd LeastNormSolution(const Eigen::MatrixXd& a,
                                  const Eigen::MatrixXd& b,
                                  double threshold);

// V diag(values) Vᵀ of a symmetric matrix, the values ascending.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
SymmetricEigen EigenOf(const Eigen::MatrixXd& symmetric);

// Singular values, descending, and right singular vectors, as many as the matrix has columns.
struct SingularValues {
  Eigen::VectorXd values;
  Eigen::MatrixXd v;
};
SingularValues SingularValuesOf(const Eigen::MatrixXd& a);

}  // namespace batten::internal
