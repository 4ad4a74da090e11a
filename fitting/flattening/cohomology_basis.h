// SPDX-License-Identifier: MIT
// First cohomology of a sheet's graph: its independent loops that cannot be contracted.
#pragma once

#include <vector>

#include "fitting/flattening/planar_edges.h"

namespace batten::internal {

// A shortest loop of its class, and how often each edge crosses the cut that every loop of the
// class crosses once and the other loops of the basis do not cross.
struct SheetLoop {
  double length;
  std::vector<int> crossings;  // of every edge from first to second: −1, 0, 1; rarely more
};

inline constexpr int kMostLoops = 64;  // so many holes are too many

// Finds a basis of loops, the longest first: none on a disc or a ball, one on a tube, two on a
// torus or a tube that branches, one more for every hole longer round than `most_filled`, the
// length (in reaches) up to which a loop is taken to enclose nothing. At most `most_loops` (up to
// kMostLoops) are sought: a result of so many means that there are more. Three nodes that are
// neighbours of each other span a triangle. Crossings are zero on a spanning tree and follow edge
// by edge from the triangles; where no more follow, a new loop is begun. The graph is connected.
// [first cohomology of the flag complex; circular coordinates from it: de Silva, Morozov &
// Vejdemo-Johansson 2011] O(n log n) a loop, and as often as a loop's length in nodes.
std::vector<SheetLoop> CohomologyBasis(const PoissonDiskSamples& nodes,
                                       const std::vector<PlanarEdge>& edges,
                                       double most_filled,
                                       int most_loops);

}  // namespace batten::internal
