// SPDX-License-Identifier: MIT
// Eigen's decompositions of small dense matrices, compiled once: a unit that instantiates one of
// its own takes 3 to 9 s longer. Innermost loops take Eigen's, of fixed sizes.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

namespace batten::internal {

// X of the least |A X − B|, by Householder's QR with pivots. The columns of A are independent:
// where they hardly are, X is rounding of any size, and where one is zero it may not be finite.
Eigen::MatrixXd LeastSquares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

// The smallest of all X of the least |A X − B|. A lacks rank where pivots of its QR are below
// `threshold` of the greatest. [Golub & Van Loan 2013, §5.5]
Eigen::MatrixXd LeastNormSolution(const Eigen::MatrixXd& a,
                                  const Eigen::MatrixXd& b,
                                  double threshold);
// The same, pivots below rounding taken for zero.
Eigen::MatrixXd LeastNormSolution(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

// X of A X = B, A square, by elimination with whole pivoting.
Eigen::MatrixXd SquareSolution(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

// The inverse of a square matrix, by elimination with row pivots; not finite where it is singular.
Eigen::MatrixXd InverseOf(const Eigen::MatrixXd& square);

// Elimination with row pivots, kept. Not finite results where the matrix is singular.
class SquareFactor {
 public:
  explicit SquareFactor(const Eigen::MatrixXd& square);
  Eigen::VectorXd Solve(const Eigen::VectorXd& right) const;
  Eigen::VectorXd SolveTransposed(const Eigen::VectorXd& right) const;

 private:
  std::shared_ptr<const Eigen::PartialPivLU<Eigen::MatrixXd>> factor_;
};

// X of A X = B, A symmetric and semidefinite, by LDLᵀ with pivots.
Eigen::MatrixXd SymmetricSolution(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
Eigen::Vector3d SymmetricSolution3(const Eigen::Matrix3d& a, const Eigen::Vector3d& b);
Eigen::Matrix3d SymmetricSolutions3(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b);

// LDLᵀ with pivots, kept.
class SymmetricFactor {
 public:
  SymmetricFactor() = default;
  explicit SymmetricFactor(const Eigen::MatrixXd& symmetric);
  Eigen::MatrixXd Solve(const Eigen::MatrixXd& right) const;
  Eigen::VectorXd Pivots() const;

 private:
  std::shared_ptr<const Eigen::LDLT<Eigen::MatrixXd>> factor_;
};

// Whole orthogonal factor of columns, by QR with pivots: its first columns span theirs, the others
// what is orthogonal to them.
Eigen::MatrixXd OrthogonalFactor(const Eigen::MatrixXd& columns);

// As many columns as there are rows, those that QR with pivots takes first.
std::vector<Eigen::Index> LeadingColumns(const Eigen::MatrixXd& a);

// V diag(values) Vᵀ of a symmetric matrix, the values ascending.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
SymmetricEigen EigenOf(const Eigen::MatrixXd& symmetric);

// The same of 3 × 3, by iterations or in closed form: several times as fast, with half the digits
// of what is small beside the greatest value.
struct SymmetricEigen3 {
  Eigen::Vector3d values;
  Eigen::Matrix3d vectors;
};
SymmetricEigen3 EigenOf3(const Eigen::Matrix3d& symmetric);
SymmetricEigen3 QuickEigenOf3(const Eigen::Matrix3d& symmetric);

// Singular values, descending, and right singular vectors, as many as the matrix has columns.
struct SingularValues {
  Eigen::VectorXd values;
  Eigen::MatrixXd v;
};
SingularValues SingularValuesOf(const Eigen::MatrixXd& a);

}  // namespace batten::internal
