// SPDX-License-Identifier: MIT
// Kernel that evaluates a tensor-product spline at scattered points: a loop over plain memory,
// compiled for several instruction sets and chosen at run time. No Eigen type crosses this header.
#pragma once

#include <cstddef>

#include "batten/fitting/point_rows.h"
#include "geometry/evaluation/kernel_tables.h"

namespace batten::internal {

// A coefficient net stored one component after the other: component d of coefficient (i, j) is
// planes[d·plane + i·row + j]. Behind the last plane there are four readable finite numbers more.
struct NetPlanes {
  const double* planes;
  std::ptrdiff_t plane, row;
};

// values[k·dimension + d] = component d at the parameters of point k, for k in [begin, end); what
// else the points hold is not read. inner: null for a curve, whose rows are of length 1. Parameters
// outside the domain as SplineBasis::Clamp takes them.
void EvaluateNet(const AxisTable& outer,
                 const AxisTable* inner,
                 const NetPlanes& net,
                 const PointRows& points,
                 std::ptrdiff_t begin,
                 std::ptrdiff_t end,
                 double* values);

}  // namespace batten::internal
