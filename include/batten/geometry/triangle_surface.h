// SPDX-License-Identifier: MIT
// Surfaces of triangles.
#pragma once

#include <Eigen/Core>

namespace batten {

// Vertices (columns, the data's units) and triangles of three vertex indices each,
// counter-clockwise seen from outside.
struct TriangleSurface {
  Eigen::Matrix3Xd vertices;
  Eigen::Matrix3Xi triangles;
};

}  // namespace batten
