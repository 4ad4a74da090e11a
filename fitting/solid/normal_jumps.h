// SPDX-License-Identifier: MIT
// How much the normals of a surface of triangles turn over its edges, and jump.
#pragma once

#include <vector>

#include "batten/geometry/triangle_surface.h"
#include "fitting/solid/triangle_topology.h"

namespace batten::internal {

// By half-edge, in radians: between the normals of its triangles, which are means over triangles
// beside one another whose own differ by less, so that noise does not count. [means: Zheng, Fu, Au
// & Tai 2011]
std::vector<double> MeanTurns(const TriangleSurface& surface, const TriangleTopology& topology);

// By half-edge, in radians, zero but where `marks` has one: how much normals jump, beyond what they
// bend beside the edge, from those near it and farther away. `walls`, by half-edge: over which
// sides do not go on.
std::vector<double> JumpsAcross(const TriangleSurface& surface,
                                const TriangleTopology& topology,
                                const std::vector<char>& walls,
                                const std::vector<char>& marks);

}  // namespace batten::internal
