// SPDX-License-Identifier: MIT
// Triangles between the nodes of a sheet, wherever it runs in space.
#pragma once

#include <array>
#include <vector>

#include "fitting/flattening/sheet_graph.h"

namespace batten::internal {

// A surface of triangles: every edge belongs to at most two of them, the triangles around a vertex
// form one fan, and all hang together.
struct SheetTriangulation {
  std::vector<std::array<int, 3>> triangles;  // nodes, counter-clockwise seen from the upper side
  std::vector<std::vector<int>> loops;        // borders with the sheet on their left, longest first
  int vertices = 0;                           // nodes that belong to triangles

  // 1 for a disc; each hole takes one away, each handle two.
  int euler_characteristic() const;
};

// Triangulates by the Delaunay triangles of each node's tangent plane: those that their three nodes
// agree upon come first, then those that two do, then others, small circles before large ones, each
// where it keeps the surface one. Nothing is laid flat as a whole, so a sheet may come to lie over
// itself in any projection. Holes of few edges and narrow notches are filled. The largest component
// is kept. O(n log n). [intrinsic triangulation by local votes; Gopi, Krishnan & Silva 2000]
SheetTriangulation TriangulateSheet(const SheetGraph& graph);

// Of a loop of nodes at these places.
double BorderLength(const Eigen::Matrix3Xd& places, const std::vector<int>& loop);

}  // namespace batten::internal
