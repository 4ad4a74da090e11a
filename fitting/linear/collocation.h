// SPDX-License-Identifier: MIT
// Spline collocation: as many conditions as control points.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// One condition on a spline: its derivative of this order (0: the spline itself) at u is given.
struct SplineCondition {
  double u;
  int order = 0;
};

// Solves for the control points (d × n) over the basis that meet the conditions, whose values are
// the columns of `values` (d × as many). There are as many conditions as the basis has different
// functions (n, periodic n − p), u in its domain and in increasing order, otherwise the band widens
// by as much as they are out of order. Derivatives are taken from the right, at the upper end from
// the left. Returns none where the conditions do not determine the spline. At the ends of splines
// of high degree the system is nearly singular: `regular` says that the Schoenberg–Whitney
// condition is known to hold, and that small pivots are no sign of the contrary. O(n·p²).
std::optional<Eigen::MatrixXd> SolveConditions(const SplineBasis& basis,
                                               const std::vector<SplineCondition>& conditions,
                                               const Eigen::MatrixXd& values,
                                               bool regular = false);

}  // namespace batten::internal
