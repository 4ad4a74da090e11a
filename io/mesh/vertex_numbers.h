// SPDX-License-Identifier: MIT
// Numbers of vertices in a file of several meshes. Not installed.
#pragma once

#include <cstdint>
#include <vector>

#include "batten/io/surface_mesh.h"

namespace batten::internal {

// For each mesh and each of its vertices its number in the file: vertices that are the same point
// have that of the first of them, all others their own, from 0 on in their order. Throws
// std::invalid_argument where joints are not one for each vertex.
std::vector<std::vector<std::int64_t>> VertexNumbers(const std::vector<SurfaceMesh>& meshes);

}  // namespace batten::internal
