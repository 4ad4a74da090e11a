// SPDX-License-Identifier: MIT
// The mesh of one surface, as it stands in a file beside others.
#pragma once

#include <Eigen/Geometry>
#include <string>

#include "batten/geometry/tessellate.h"

namespace batten {

struct SurfaceMesh {
  TriangleMesh mesh;
  std::string name = {};  // UTF-8; empty: surface-1, surface-2, … by its place among the meshes
  // Of its parameters: what texture coordinates of GLB run over; empty: the box of those there are.
  Eigen::AlignedBox2d domain = {};
  // Signed, one for each vertex, NaN where it is not known; or none at all.
  Eigen::VectorXd deviations = {};
};

}  // namespace batten
