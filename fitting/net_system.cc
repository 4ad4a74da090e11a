// SPDX-License-Identifier: MIT
#include "batten/fitting/net_system.h"

#include <algorithm>
#include <limits>

namespace batten {
namespace {

int Different(const SplineBasis& basis) {
  return basis.periodic() ? basis.size() - basis.degree() : basis.size();
}

int Bandwidth(const SplineBasis& basis) {
  const int reach = basis.periodic() ? 2 * basis.degree() : basis.degree();
  return std::min(reach, Different(basis) - 1);
}

}  // namespace

NetSystem::NetSystem(const SplineBasis& basis, int dimension)
    : dimension_(dimension),
      place_(static_cast<size_t>(basis.size())),
      matrix_(Different(basis), dimension, Bandwidth(basis)),
      right_(Eigen::VectorXd::Zero(Eigen::Index{Different(basis)} * dimension)) {
  const int different = Different(basis);
  for (int i = 0; i < basis.size(); ++i) {
    const int j = i % different;
    const bool upper_half = 2 * j >= different;
    place_[i] = !basis.periodic() ? i : upper_half ? 2 * (different - 1 - j) + 1 : 2 * j;
  }
}

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

}  // namespace batten
