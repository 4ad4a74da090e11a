// SPDX-License-Identifier: MIT
// The direction that a sheet's normals keep nearest to.
#pragma once

#include <Eigen/Core>

namespace batten::internal {

struct NormalConeOptions {
  double share = 0.05;     // of the normals may lie outside the cone
  bool one_sided = false;  // normals' signs count; else they are lines
  int rounds = 60;
};

// Towards the axis of the smallest cone about normals (3 × n, of length 1) but for a share of them:
// from `start` (of length 1) on, repeated means with those that are steepest; the best axis that
// was met. O(n · rounds). [Bădoiu & Clarkson 2003, for balls]
Eigen::Vector3d NormalCone(const Eigen::Matrix3Xd& normals,
                           const Eigen::Vector3d& start,
                           const NormalConeOptions& options);

}  // namespace batten::internal
