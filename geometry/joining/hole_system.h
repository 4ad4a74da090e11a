// SPDX-License-Identifier: MIT
// The control points of least bending energy that keep tangent planes along all edges of a hole.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/joining/hole_net.h"
#include "geometry/joining/hole_sides.h"

namespace batten::internal {

// See fill.h. One sparse factorization and a few solutions with it.
Eigen::Matrix3Xd SolvedHole(const HoleNet& net, const std::vector<HoleSide>& sides);

}  // namespace batten::internal
