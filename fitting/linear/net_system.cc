// SPDX-License-Identifier: MIT
#include "fitting/linear/net_system.h"

#include <limits>

#include "fitting/linear/coefficient_order.h"

namespace batten::internal {
NetSystem::NetSystem(const SplineBasis& basis, int dimension)
    : dimension_(dimension),
      place_(CoefficientOrder(basis).Rows(basis)),
      matrix_(DistinctCount(basis), dimension, CoefficientOrder(basis).bandwidth()),
      right_(Eigen::VectorXd::Zero(Eigen::Index{DistinctCount(basis)} * dimension)) {}

NetSystem::Step NetSystem::Solve() {
  constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon(), kRaise = 100;
  const double mean = matrix_.Trace() / matrix_.size();
  const BlockBandedMatrix plain = matrix_;
  Eigen::MatrixXd solution;
  for (double ridge = kRounding * mean; ridge > 0 && ridge <= mean; ridge *= kRaise) {
    matrix_ = plain;
    matrix_.AddToDiagonal(ridge);
    if (!matrix_.Factor()) continue;
    solution = right_;
    matrix_.Solve(solution);
    if (solution.allFinite()) break;
  }
  Step step{Eigen::MatrixXd::Zero(dimension_, static_cast<Eigen::Index>(place_.size())), 0};
  if (solution.size() == 0 || !solution.allFinite()) return step;
  step.promise = solution.col(0).dot(right_);
  for (size_t i = 0; i < place_.size(); ++i) {
    step.net.col(static_cast<Eigen::Index>(i)) =
        solution.col(0).segment(Eigen::Index{place_[i]} * dimension_, dimension_);
  }
  return step;
}

}  // namespace batten::internal
