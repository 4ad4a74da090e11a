// SPDX-License-Identifier: MIT
// Vertices and faces as a file has them.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace batten {

// Vertices (columns, the file's own coordinates) and faces of three or more vertex indices each.
struct PolygonMesh {
  Eigen::Matrix3Xd vertices;
  std::vector<std::vector<int>> faces;
};

}  // namespace batten
