// SPDX-License-Identifier: MIT
// PCL's surface reconstruction behind a pointer: its library loads thirty others.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace batten::internal {

struct PoissonSurface {
  Eigen::Matrix3Xd vertices;
  std::vector<std::vector<int>> faces;
};

// What the module `libbatten_reconstruction.so` does (io/reconstruction). It hands out the address
// of one such table: `batten_reconstruction_functions`.
struct PoissonFunctions {
  // Of points in about the unit cube and their unit normals; an octree of so many levels.
  PoissonSurface (*reconstruct)(const Eigen::Matrix3Xd& points,
                                const Eigen::Matrix3Xd& normals,
                                int depth);
};

}  // namespace batten::internal
