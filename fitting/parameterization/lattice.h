// SPDX-License-Identifier: MIT
// Height fields over the nodes of a regular lattice: rasters, such as elevation models.
#pragma once

#include <Eigen/Core>
#include <optional>

namespace batten::internal {

// Finds the coordinate axis along which points (3 × m) are heights over a regular lattice of the
// other two coordinates: values evenly spaced to a hundredth of their step in each, none of its
// nodes twice, at least three in five of them taken, and four rows and columns. z before y before
// x. None where the points are no lattice; then O(1), else O(m).
std::optional<int> AxisOfLatticeHeights(const Eigen::Matrix3Xd& points);

}  // namespace batten::internal
