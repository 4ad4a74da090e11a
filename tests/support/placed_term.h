// SPDX-License-Identifier: MIT
// A user's term that wants one control point at a place.
#pragma once

#include <Eigen/Core>
#include <span>
#include <utility>
#include <vector>

#include "batten/fitting/residual_term.h"

namespace batten::internal {

class PlacedTerm : public ResidualTerm {
 public:
  // weight² counts as that many points of weight 1.
  PlacedTerm(int point, Eigen::VectorXd place, double weight)
      : point_(point), place_(std::move(place)), weight_(weight) {}

  int residuals() const override { return static_cast<int>(place_.size()); }
  std::vector<int> ControlPoints() const override { return {point_}; }
  bool Evaluate(std::span<const double> values,
                std::span<double> residual,
                std::span<double> jacobian) const override {
    const Eigen::Index dim = place_.size();
    Eigen::Map<Eigen::VectorXd>(residual.data(), dim) =
        weight_ * (Eigen::Map<const Eigen::VectorXd>(values.data(), dim) - place_);
    if (!jacobian.empty())
      Eigen::Map<Eigen::MatrixXd>(jacobian.data(), dim, dim) =
          weight_ * Eigen::MatrixXd::Identity(dim, dim);
    return true;
  }

 private:
  int point_;
  Eigen::VectorXd place_;
  double weight_;
};

}  // namespace batten::internal
