// SPDX-License-Identifier: MIT
#include "fitting/solid/split_preconditioner.h"

namespace batten::internal {
namespace {

Eigen::Matrix3Xd Across(const Eigen::Matrix3Xd& normals, const Eigen::Matrix3Xd& vectors) {
  const Eigen::RowVectorXd along = normals.cwiseProduct(vectors).colwise().sum();
  return vectors - normals * along.asDiagonal();
}

}  // namespace

bool SplitPreconditioner::Factor(const Eigen::SparseMatrix<double>& along,
                                 const Eigen::SparseMatrix<double>& across,
                                 ThreadPool& pool) {
  if (!analysed_) {
    along_.analyzePattern(along);
    across_.analyzePattern(across);
    analysed_ = true;
  }
  pool.For(2, 1, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      k == 0 ? along_.factorize(along) : across_.factorize(across);
    }
  });
  return along_.info() == Eigen::Success && across_.info() == Eigen::Success;
}

Eigen::Matrix3Xd SplitPreconditioner::Apply(const Eigen::Matrix3Xd& normals,
                                            const Eigen::Matrix3Xd& pulls) const {
  const Eigen::VectorXd along = normals.cwiseProduct(pulls).colwise().sum().transpose();
  const Eigen::MatrixX3d rest = across_.solve(Across(normals, pulls).transpose());
  return normals * along_.solve(along).asDiagonal() + Across(normals, rest.transpose());
}

}  // namespace batten::internal
