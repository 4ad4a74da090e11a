// SPDX-License-Identifier: MIT
// What meshes in one file are together.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/io/surface_mesh.h"

namespace batten {

// What meshes are together, vertices that are the same point being one.
struct MeshCensus {
  Eigen::Index vertices = 0, triangles = 0;
  // That do not lie between two triangles which run along them in opposite directions; 0:
  // watertight.
  Eigen::Index open_edges = 0;
};
MeshCensus CensusOf(const std::vector<SurfaceMesh>& meshes);

}  // namespace batten
