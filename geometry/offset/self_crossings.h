// SPDX-License-Identifier: MIT
// Places where a surface crosses itself. Internal to geometry.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

struct SelfCrossing {
  Eigen::Vector2d first, second;  // (u, v)
  Eigen::Vector3d point;
};

// Places in pairs of Bézier patches that are not neighbours, found by halving until their normal
// cones share no line and Newton's method finds one in both; smaller than 1/1000 of the size they
// are left. At most `most` places, and one for each pair of patches.
std::vector<SelfCrossing> SelfCrossings(const NurbsSurface& surface,
                                        double tolerance,
                                        std::size_t most);

}  // namespace batten::internal
