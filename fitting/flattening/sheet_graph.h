// SPDX-License-Identifier: MIT
// Which nodes of a sheet are next to each other along it.
#pragma once

#include <vector>

#include "fitting/flattening/poisson_disk_samples.h"

namespace batten::internal {

struct SheetEdge {
  int first, second;  // first < second
};

// The nodes of the largest connected part and the edges among them.
struct SheetGraph {
  PoissonDiskSamples nodes;  // signs of normals agree along the edges
  std::vector<SheetEdge> edges;
  std::vector<SheetEdge> contradictions;  // edges along which they do not: left out of the others
  double share = 0;                       // of all nodes
};

// What an edge must keep to, so that none leads from one turn of a roll to the next.
struct SheetGraphOptions {
  int neighbours = 8;         // a node asks for
  double longest = 2.6;       // in reaches of the end that has the smaller one
  double steepest = 0.5;      // sine of its angle to either tangent plane
  double least_cosine = 0.5;  // of the angle between the planes
};

// Every node asks for its nearest neighbours that keep to the options; an edge exists where one of
// both asks. Signs spread along the spanning tree of the flattest edges. [Hoppe et al. 1992, §3.3]
// O(n log n).
SheetGraph ConnectSheet(const PoissonDiskSamples& nodes, const SheetGraphOptions& options);

// For every node its neighbours, in increasing order.
std::vector<std::vector<int>> NeighboursOf(Eigen::Index nodes, const std::vector<SheetEdge>& edges);

// Of every node the nodes at most two edges away, itself included, in increasing order.
std::vector<std::vector<int>> TwoRings(const std::vector<std::vector<int>>& neighbours);

}  // namespace batten::internal
