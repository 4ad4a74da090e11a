// SPDX-License-Identifier: MIT
// Second derivatives at a spline's ends that give it the curvatures asked for there.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

namespace batten::internal {

// First derivatives at the start and the end of a spline as its second derivatives M there make
// them: own[i] + Σ by(i, j) M_j. What is not free has a column of zeros.
template <int Dim>
struct EndSlopes {
  std::array<Eigen::Matrix<double, Dim, 1>, 2> own;
  Eigen::Matrix2d by = Eigen::Matrix2d::Zero();

  using Seconds = std::array<Eigen::Matrix<double, Dim, 1>, 2>;
  Eigen::Matrix<double, Dim, 1> At(int end, const Seconds& second) const {
    return own[end] + by(end, 0) * second[0] + by(end, 1) * second[1];
  }
};

// A curvature asked for at an end, as CubicEndCondition has it.
template <int Dim>
struct EndCurvature {
  Eigen::Matrix<double, Dim, 1> value;
  bool of_function = false;  // of the first coordinate, whose second derivative is zero
};
template <int Dim>
using EndCurvatures = std::array<std::optional<EndCurvature<Dim>>, 2>;

// The second derivatives at the ends that are to have curvatures (zero at the others), to
// 1e-12: followed from the spline without curvatures while those grow to what is asked for, by
// Newton's method; where that branch turns back, from starts of other speeds. None where no start
// leads to a spline whose ends run no faster than `wild`.
template <int Dim>
std::optional<typename EndSlopes<Dim>::Seconds> SecondsOfCurvatures(
    const EndCurvatures<Dim>& curvatures, const EndSlopes<Dim>& slopes, double wild);

}  // namespace batten::internal
