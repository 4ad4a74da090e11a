// SPDX-License-Identifier: MIT
// The triangles inside a triangulated domain as a mesh of its surface. Internal to geometry.
#pragma once

#include <vector>

#include "batten/geometry/triangle_mesh.h"
#include "geometry/mesh/domain_mesh.h"

namespace batten::internal {

struct ExtractedMesh {
  TriangleMesh mesh;
  std::vector<int> origins;  // of its vertices: the vertices of the triangulation
};

// `names`: of every vertex, the one that stands for it. Triangles with two vertices of one name are
// left out.
ExtractedMesh ExtractMesh(const DomainMesh& mesh, const std::vector<int>& names);

}  // namespace batten::internal
