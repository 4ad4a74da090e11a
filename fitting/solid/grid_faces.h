// SPDX-License-Identifier: MIT
// Faces of a layout from a map onto the grid.
#pragma once

#include "batten/geometry/quad_mesh.h"
#include "fitting/solid/grid_map.h"

namespace batten::internal {

// The unit squares of the grid as faces on the surface: every place that is mapped onto the middle
// of a square is one, and lines of the grid through it lead to the four beside. Vertices are the
// means of the middles of their faces. Edges are creases where the line over them crosses creases
// an odd number of times. Throws RefusedData where the lines do not lead from face to face and
// back.
QuadMesh FacesOfGrid(const TriangleSurface& surface,
                     const TriangleTopology& topology,
                     const GridMap& map,
                     const std::vector<char>& creases);  // by half-edge

}  // namespace batten::internal
