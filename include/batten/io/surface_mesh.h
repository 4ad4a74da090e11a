// SPDX-License-Identifier: MIT
// The mesh of one surface, as it stands in a file beside others.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "batten/geometry/triangle_mesh.h"

namespace batten {

struct SurfaceMesh {
  TriangleMesh mesh;
  std::string name = {};  // UTF-8; empty: surface-1, surface-2, … by its place among the meshes
  // Of its parameters: what texture coordinates of GLB run over; empty: the box of those there are.
  Eigen::AlignedBox2d domain = {};
  // Signed, one for each vertex, NaN where it is not known; or none at all.
  Eigen::VectorXd deviations = {};
  // For each vertex a number that it has in common with the vertices of other meshes that are the
  // same point, −1: none (ShellMesh::joints); or none at all.
  std::vector<int> joints = {};
};

}  // namespace batten
