// SPDX-License-Identifier: MIT
// The inside of plane loops cut by curves. Internal to geometry.
#pragma once

#include <functional>
#include <vector>

#include "batten/geometry/nurbs_curve.h"

namespace batten::internal {

// A connected part: its outer boundary, counter-clockwise, then its holes, clockwise.
struct RegionPart {
  std::vector<NurbsCurve<2>> loops;
  bool left = false;  // of the curves that bound it; else right
};

// The parts into which directed curves cut the inside of loops, which are turned as NurbsSurface
// describes them; `inside` tells that inside, its boundary included. None where no curve passes.
// Boundaries are made of pieces of the loops and of the curves' parts inside, which the parts on
// either side share control point by control point. Curves may be closed or go through; what of
// them lies outside is dropped. They must not cross each other or themselves. Places within
// `tolerance` of one another are one.
// Throws std::invalid_argument, with `function` in front, where a curve ends inside or runs along a
// loop. O(pieces²) and the crossings.
std::vector<RegionPart> CutLoops(const std::vector<NurbsCurve<2>>& loops,
                                 const std::vector<NurbsCurve<2>>& curves,
                                 const std::function<bool(const Eigen::Vector2d&)>& inside,
                                 double tolerance,
                                 const char* function);

}  // namespace batten::internal
