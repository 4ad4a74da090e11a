// SPDX-License-Identifier: MIT
// A function of one parameter as a cubic spline, within a tolerance.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "batten/geometry/spline_basis.h"

namespace batten::internal {

enum class Side { kBelow, kAbove };  // where a function has two values, as at a kink

struct ValueAndSlope {
  Eigen::VectorXd value, slope;
};
using VectorFunction = std::function<ValueAndSlope(double at, Side side)>;

// A place where the function is less than smooth, C^continuity with 0 ≤ continuity ≤ 2, or that is
// to be met.
struct FunctionBreak {
  double at;
  int continuity = 2;
};

struct CubicApproximation {
  SplineBasis basis;             // clamped; a knot of multiplicity 3 − continuity at every break
  Eigen::MatrixXd coefficients;  // a column for each function of the basis
  double error;                  // largest found, by the measure
};

// The complete cubic spline: value at every break, slope at the ends and where the function is only
// C^1, both slopes at kinks. Intervals are parted where `measure` of (spline − function) is above
// the tolerance at one of eleven even places inside, until none is; errors are of fourth order. The
// breaks increase, first and last are the ends of the domain. `what` names the function in
// messages. Throws std::invalid_argument where 20,000 intervals do not reach the tolerance.
// [de Boor 1978, V]
CubicApproximation ApproximateByCubic(const VectorFunction& function,
                                      const std::vector<FunctionBreak>& breaks,
                                      const std::function<double(const Eigen::VectorXd&)>& measure,
                                      double tolerance,
                                      const char* what);

}  // namespace batten::internal
