// SPDX-License-Identifier: MIT
#include "fitting/linear/independent_rows.h"

#include "fitting/core/rounding.h"

namespace batten::internal {

IndependentRows::IndependentRows(const Eigen::MatrixXd& rows, const Eigen::VectorXd& scales)
    : orthonormal_(rows.cols(), rows.rows()),
      triangle_(Eigen::MatrixXd::Zero(rows.rows(), rows.rows())) {
  Eigen::Index rank = 0;
  for (Eigen::Index k = 0; k < rows.rows(); ++k) {
    Eigen::VectorXd rest = rows.row(k).transpose();
    Eigen::VectorXd shares = Eigen::VectorXd::Zero(rank);
    for (int pass = 0; pass < 2; ++pass) {
      const Eigen::VectorXd share = orthonormal_.leftCols(rank).transpose() * rest;
      rest -= orthonormal_.leftCols(rank) * share;
      shares += share;
    }
    const double length = rest.norm();
    if (!(length > kRelativelyEqual * scales[k])) continue;
    triangle_.row(rank).head(rank) = shares.transpose();
    triangle_(rank, rank) = length;
    orthonormal_.col(rank++) = rest / length;
    kept_.push_back(k);
  }
  orthonormal_.conservativeResize(Eigen::NoChange, rank);
  triangle_.conservativeResize(rank, rank);
}

Eigen::VectorXd IndependentRows::LeastSolution(const Eigen::VectorXd& values) const {
  return orthonormal_ * triangle_.triangularView<Eigen::Lower>().solve(values);
}

}  // namespace batten::internal
