// SPDX-License-Identifier: MIT
// Linear systems for a curve's control points with coupled coordinates. Internal.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "fitting/linear/block_banded_matrix.h"
#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// A symmetric system H·δ = b over a net of n control points of d coordinates, with d × d blocks.
// Over a periodic basis the last p points are the first p; the different ones are in the order of
// CoefficientOrder, which makes their cyclic band a plain one.
class NetSystem {
 public:
  NetSystem(const SplineBasis& basis, int dimension);

  // Adds `value` (d × d, symmetric) to the block of control points i and j; symmetric pairs are to
  // be added once: (i, j) stands for (j, i) too.
  template <typename Derived>
  void Add(int i, int j, const Eigen::MatrixBase<Derived>& value) {
    const int a = place_[i], b = place_[j];
    if (a >= b) matrix_.at(a, a - b) += value;
    if (b > a || (a == b && i != j)) matrix_.at(b, b - a) += value.transpose();
  }

  // Adds to the right-hand side of control point i.
  template <typename Derived>
  void AddRight(int i, const Eigen::MatrixBase<Derived>& value) {
    right_.segment(Eigen::Index{place_[i]} * dimension_, dimension_) += value;
  }

  // The step δ (d × n) and δᵀb. A matrix singular to rounding is damped on the diagonal as far as
  // needed. May be called once.
  struct Step {
    Eigen::MatrixXd net;
    double promise = 0;
  };
  Step Solve();

 private:
  int dimension_;
  std::vector<int> place_;  // of every control point among the unknowns
  BlockBandedMatrix matrix_;
  Eigen::VectorXd right_;
};

}  // namespace batten::internal
