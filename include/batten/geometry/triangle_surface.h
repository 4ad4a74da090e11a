// SPDX-License-Identifier: MIT
// Surfaces of triangles.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace batten {

// Vertices (columns, the data's units) and triangles of three vertex indices each,
// counter-clockwise seen from outside.
struct TriangleSurface {
  Eigen::Matrix3Xd vertices;
  Eigen::Matrix3Xi triangles;
  // By triangle: whether it only closes the surface, where nothing was measured; empty: none does.
  std::vector<char> caps = {};
};

}  // namespace batten
