// SPDX-License-Identifier: MIT
// Rolling the nodes of a tube off into the plane.
#pragma once

#include <vector>

#include "fitting/flattening/arap_flattening.h"
#include "fitting/flattening/planar_edges.h"

namespace batten::internal {

// As Unfold, over places that repeat: minimises Σ w |z_j + c_ij P − z_i − r_i q_ij|² over places,
// rotations and the period P, c_ij the crossings of the edges. Starts from the rotations that lay
// the gradient of the harmonic angle round the tube along the real axis: they close round it
// whatever the tube's curvature; a few rounds then even out what holes did to it. In the end all is
// turned so that P is real. Where lengths round the tube differ, they are shared out over one
// period. The crossings are those of a loop that no sum of triangles makes vanish. O(n^1.5) and
// rounds of O(n log n).
Flattening FlattenTubeArap(const SheetGraph& graph,
                           const std::vector<PlanarEdge>& edges,
                           const std::vector<int>& crossings);

}  // namespace batten::internal
