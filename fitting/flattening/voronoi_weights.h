// SPDX-License-Identifier: MIT
// The part of a sheet that belongs to each of its nodes, and the borders of the parts.
#pragma once

#include <vector>

#include "fitting/flattening/sheet_graph.h"

namespace batten::internal {

// Two nodes whose parts touch, and the length of their common border over their distance.
struct SheetOutline {
  int first, second;  // first < second
  double weight;      // > 0
};

// Voronoi cells of the nodes among their graph neighbours and those of these, each in its own
// tangent plane and cut off at 1.7 reaches where the sheet ends; the weight is the mean of what
// both ends say. Over a cell Σ w q = 0, q the ways to the other nodes, so that a Laplacian with
// these weights is exact for linear functions, and Σ w |q|² = 4 area. All edges of the graph are
// there, be it with a small weight, so that what was connected stays so. O(n). [the cotangent
// weights of Pinkall & Polthier 1993, from the Voronoi diagram]
std::vector<SheetOutline> VoronoiEdgeWeights(const SheetGraph& graph);

}  // namespace batten::internal
