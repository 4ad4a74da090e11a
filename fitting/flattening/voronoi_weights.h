// SPDX-License-Identifier: MIT
// Edge weights of a sheet's graph from the Voronoi cells of its nodes.
#pragma once

#include <vector>

#include "fitting/flattening/sheet_graph.h"

namespace batten::internal {

// In reaches, of circles through three nodes. Discs thrown until none fits leave circles below one
// reach and one spacing of the points, which is at most two thirds of a reach. Larger values bridge
// bays of the border, smaller ones leave holes. [derived]
inline constexpr double kLargestCircle = 1.7;

// A convex polygon in a node's tangent plane, counter-clockwise; `beyond[k]` is the node behind the
// side from corner k to the next, or −1.
struct VoronoiCell {
  std::vector<Eigen::Vector2d> corners;
  std::vector<int> beyond;
};

// The Voronoi cell of node i among the nodes `around` it, laid into its tangent plane at their
// distances in space, within a polygon of 16 sides of `radius` reaches. O(nodes around · corners).
VoronoiCell VoronoiCellOf(const PoissonDiskSamples& nodes,
                          int i,
                          const std::vector<int>& around,
                          double radius);

// Two nodes whose Voronoi cells touch, and the length of their common border over their distance.
struct SheetOutline {
  int first, second;  // first < second
  double weight;      // > 0
};

// Computes the weights from Voronoi cells of the nodes among their neighbours within two edges,
// each cell in its own tangent plane and cut off at 1.7 reaches where the sheet ends; a weight is
// the mean of those at both ends. Over a cell Σ w q = 0, q the vectors to the other nodes, so that
// a Laplacian with these weights is exact for linear functions, and Σ w |q|² = 4 area. All edges of
// the graph are included, some with a small weight, so that its components stay connected. O(n).
// [the cotangent weights of Pinkall & Polthier 1993, from the Voronoi diagram]
std::vector<SheetOutline> VoronoiEdgeWeights(const SheetGraph& graph);

}  // namespace batten::internal
