// SPDX-License-Identifier: MIT
// What keeps the trim loops of a surface from bounding a region.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

struct TrimFault {
  int loop = 0;
  int other = -1;  // the loop that crosses or overlaps it, itself where it crosses itself; −1: none
  Eigen::Vector2d at =
      Eigen::Vector2d::Zero();  // a place of the domain near it, where there is one
  std::string rule;             // the broken rule of CheckTrims, loops named
};

// The faults of the trims in the order in which CheckTrims looks for them, ten thousand at most;
// none where it accepts them; of two loops' faults within a thousandth of the domain one. Cost:
// that of CheckTrims.
std::vector<TrimFault> TrimFaults(const NurbsSurface& surface);

}  // namespace batten::internal
