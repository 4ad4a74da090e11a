// SPDX-License-Identifier: MIT
// Normal cone of a sheet: the direction closest to all of its normals.
#pragma once

#include <Eigen/Core>

namespace batten::internal {

struct NormalConeOptions {
  double share = 0.05;     // share of the normals that may lie outside the cone
  bool one_sided = false;  // signs of the normals count; else normals are lines
  int rounds = 60;
};

// Approximates the axis of the smallest cone that holds the unit normals (3 × n) but for a share of
// them. Iterates from `start` (of length 1) by averaging with the steepest normals, and returns the
// best axis met. O(n · rounds). [Bădoiu & Clarkson 2003, for balls]
Eigen::Vector3d NormalCone(const Eigen::Matrix3Xd& normals,
                           const Eigen::Vector3d& start,
                           const NormalConeOptions& options);

}  // namespace batten::internal
