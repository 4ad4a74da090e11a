// SPDX-License-Identifier: MIT
// Three or four curves that go round, as the sides of a square.
#pragma once

#include <array>
#include <vector>

#include "batten/geometry/nurbs_curve.h"

namespace batten::internal {

struct BoundaryLoop {
  std::vector<NurbsCurve<3>> along_u;      // v = 0 and v = 1
  std::vector<NurbsCurve<3>> along_v;      // u = 0 and u = 1
  std::array<Eigen::Vector3d, 4> corners;  // (0,0), (1,0), (0,1), (1,1)
  double gap = 0;
};

// Clamped sides on [0, 1] that begin and end at the corners exactly; coons_surface.h says in which
// order. Throws std::invalid_argument in the name of Coons.
BoundaryLoop LoopOf(const std::vector<NurbsCurve<3>>& sides, double tolerance);

}  // namespace batten::internal
