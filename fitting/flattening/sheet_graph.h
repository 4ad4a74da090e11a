// SPDX-License-Identifier: MIT
// Neighbour graph of the nodes of a sheet.
#pragma once

#include <vector>

#include "fitting/flattening/poisson_disk_samples.h"

namespace batten::internal {

struct SheetEdge {
  int first, second;  // first < second
};

// The nodes of the largest connected component and the edges among them.
struct SheetGraph {
  PoissonDiskSamples nodes;  // signs of normals agree along the edges
  std::vector<SheetEdge> edges;
  std::vector<SheetEdge> contradictions;  // edges along which signs disagree: not in `edges`
  double share = 0;                       // of all nodes
};

// Share of the nodes that must hang together: fewer are part of a cloud of several sheets.
inline constexpr double kConnectedShare = 0.9;

// Limits on edges, so that none leads from one turn of a roll to the next.
struct SheetGraphOptions {
  int neighbours = 8;         // nearest neighbours that a node is joined to
  double longest = 2.6;       // length in reaches of the end with the smaller reach
  double steepest = 0.5;      // sine of the edge's angle to either tangent plane
  double least_cosine = 0.5;  // cosine of the angle between the planes
};

// Builds the graph: an edge joins two nodes if either is among the other's nearest neighbours
// within the limits. Signs of the normals are spread along the minimum spanning tree of the
// flattest edges. [Hoppe et al. 1992, §3.3] O(n log n).
SheetGraph ConnectSheet(const PoissonDiskSamples& nodes, const SheetGraphOptions& options);

// Returns the neighbours of every node, in increasing order.
std::vector<std::vector<int>> NeighboursOf(Eigen::Index nodes, const std::vector<SheetEdge>& edges);

// Returns the nodes at most two edges away from every node, itself included, in increasing order.
std::vector<std::vector<int>> TwoRings(const std::vector<std::vector<int>>& neighbours);

}  // namespace batten::internal
