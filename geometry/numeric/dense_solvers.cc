// SPDX-License-Identifier: MIT
#include "geometry/numeric/dense_solvers.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <limits>

namespace batten::internal {

Eigen::MatrixXd LeastSquares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.colPivHouseholderQr().solve(b);
}

Eigen::MatrixXd LeastNormSolution(const Eigen::MatrixXd& a,
                                  const Eigen::MatrixXd& b,
                                  double threshold) {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
  solver.setThreshold(threshold);
  return solver.compute(a).solve(b);
}

Eigen::MatrixXd LeastNormSolution(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const auto least = static_cast<double>(std::min(a.rows(), a.cols()));
  return LeastNormSolution(a, b, least * std::numeric_limits<double>::epsilon());
}

Eigen::MatrixXd SquareSolution(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.fullPivLu().solve(b);
}

Eigen::MatrixXd InverseOf(const Eigen::MatrixXd& square) { return square.partialPivLu().inverse(); }

SquareFactor::SquareFactor(const Eigen::MatrixXd& square)
    : factor_(std::make_shared<const Eigen::PartialPivLU<Eigen::MatrixXd>>(square)) {}

Eigen::VectorXd SquareFactor::Solve(const Eigen::VectorXd& right) const {
  return factor_->solve(right);
}

Eigen::VectorXd SquareFactor::SolveTransposed(const Eigen::VectorXd& right) const {
  return factor_->transpose().solve(right);
}

Eigen::MatrixXd SymmetricSolution(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return SymmetricFactor(a).Solve(b);
}

Eigen::Vector3d SymmetricSolution3(const Eigen::Matrix3d& a, const Eigen::Vector3d& b) {
  return a.ldlt().solve(b);
}

Eigen::Matrix3d SymmetricSolutions3(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return a.ldlt().solve(b);
}

SymmetricFactor::SymmetricFactor(const Eigen::MatrixXd& symmetric)
    : factor_(std::make_shared<const Eigen::LDLT<Eigen::MatrixXd>>(symmetric)) {}

Eigen::MatrixXd SymmetricFactor::Solve(const Eigen::MatrixXd& right) const {
  return factor_->solve(right);
}

Eigen::VectorXd SymmetricFactor::Pivots() const { return factor_->vectorD(); }

Eigen::MatrixXd OrthogonalFactor(const Eigen::MatrixXd& columns) {
  return columns.colPivHouseholderQr().householderQ();
}

std::vector<Eigen::Index> LeadingColumns(const Eigen::MatrixXd& a) {
  const auto order = a.colPivHouseholderQr().colsPermutation().indices();
  return {order.begin(), order.begin() + a.rows()};
}

SymmetricEigen EigenOf(const Eigen::MatrixXd& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

SymmetricEigen3 EigenOf3(const Eigen::Matrix3d& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

SymmetricEigen3 QuickEigenOf3(const Eigen::Matrix3d& symmetric) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

// Of the triangular factor: of many rows far faster, and as exact.
SingularValues SingularValuesOf(const Eigen::MatrixXd& a) {
  const Eigen::Index n = a.cols();
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(std::max(n, a.rows()), n);
  rows.topRows(a.rows()) = a;
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(rows);
  const Eigen::MatrixXd r = qr.matrixQR().topRows(n).triangularView<Eigen::Upper>();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(r, Eigen::ComputeFullV);
  return {svd.singularValues(), svd.matrixV()};
}

}  // namespace batten::internal
