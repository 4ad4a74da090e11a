// SPDX-License-Identifier: MIT
// Limits of the choice of a knot grid: degrees, control points, search range and noise.
#pragma once

#include <limits>

namespace batten::internal {

struct GridLimits {
  int degree_u = 3, degree_v = 3;
  int max_control_points = 20000;
  // A grid chosen for nearly the same data: only its surroundings are searched. Both 0: everything.
  int near_cells_u = 0, near_cells_v = 0;
  bool blocks = true;  // check the choice by leaving out blocks of points
  // Standard deviation of the data as nearest neighbours tell, > 0: residuals several times as
  // large are shape, not correlated noise.
  double noise = std::numeric_limits<double>::infinity();
};

}  // namespace batten::internal
