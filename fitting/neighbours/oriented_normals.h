// SPDX-License-Identifier: MIT
// Normals of the points of a closed body, all outwards.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/neighbours.h"

namespace batten::internal {

// Unit normals of planes through k neighbours. From the outermost point on, along edges of least
// turn between neighbours, each takes the sign that agrees; parts without a neighbour in common
// begin at their own outermost points. O(m k log m). [Hoppe et al. 1992]
Eigen::Matrix3Xd OutwardNormals(const NeighbourIndex& index, const Eigen::Matrix3Xd& points, int k);

}  // namespace batten::internal
