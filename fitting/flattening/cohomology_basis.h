// SPDX-License-Identifier: MIT
// The ways round a sheet that cannot be drawn together, counted along its graph.
#pragma once

#include <vector>

#include "fitting/flattening/planar_edges.h"

namespace batten::internal {

// A closed way of least length among those of its kind, and how often every edge crosses the cut
// that all ways of this kind cross once and those of the other loops not at all.
struct SheetLoop {
  double length;
  std::vector<int> crossings;  // of every edge from first to second: −1, 0, 1; rarely more
};

// One loop for each way round, the longest first: none on a disc or a ball, one on a tube, two on a
// torus or a tube that branches, one more for every hole larger than `most_filled`, the length of
// a closed way in reaches that is taken to enclose nothing. At most `most_loops` (64 and less) are
// looked for: so many mean that there are more. Neighbours of neighbours that are neighbours span a
// triangle; the crossings of an edge follow from the triangles it is in, edge by edge from a
// spanning tree that crosses nothing; where nothing follows any more a new loop begins. The graph
// is connected. [first cohomology of the flag complex; circular coordinates from it: de Silva,
// Morozov & Vejdemo-Johansson 2011] O(n log n) a loop, and as often as a loop's length in nodes.
std::vector<SheetLoop> CohomologyBasis(const PoissonDiskSamples& nodes,
                                       const std::vector<PlanarEdge>& edges,
                                       double most_filled,
                                       int most_loops);

}  // namespace batten::internal
