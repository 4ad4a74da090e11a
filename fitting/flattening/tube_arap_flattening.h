// SPDX-License-Identifier: MIT
// As-rigid-as-possible (ARAP) flattening of the nodes of a tube into a periodic strip.
#pragma once

#include <vector>

#include "fitting/flattening/arap_flattening.h"
#include "fitting/flattening/planar_edges.h"

namespace batten::internal {

// Flattens a tube as FlattenArap does a sheet, over periodic places: minimises
// Σ w |z_j + c_ij P − z_i − r_i q_ij|² over places, rotations and the period P, c_ij the crossings
// of the edges. The initial rotations turn the gradient of the harmonic angle round the tube to the
// real axis: they close round it whatever the tube's curvature; a few rounds then even out the
// effect of holes. The result is rotated so that P is real. Where lengths round the tube differ,
// the differences are distributed over one period. The crossings are those of a loop that is no sum
// of triangles. O(n^1.5) and rounds of O(n log n).
Flattening FlattenTubeArap(const SheetGraph& graph,
                           const std::vector<PlanarEdge>& edges,
                           const std::vector<int>& crossings);

}  // namespace batten::internal
