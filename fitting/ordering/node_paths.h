// SPDX-License-Identifier: MIT
// Linking of nodes along curves into paths.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace batten::internal {

// Nodes in order; a closed path does not repeat the first.
struct NodePath {
  std::vector<int> nodes;
  bool closed = false;
};

// Links the nodes into paths, each node on exactly one: links are made from short to long, a node
// has at most two, and a link across the direction in which the nodes around run counts as longer
// than it is. A link much longer than those before it is made only where it bridges a gap: two ends
// that face each other within 30° and a gap below 0.1 of the length. A path closes in the same way.
// Longest first. The result depends on nothing but the nodes and their order. O(n log n). [The
// greedy edge rule, Bentley 1992; gaps and directions are of our own.]
std::vector<NodePath> LinkNodes(const Eigen::Matrix3Xd& nodes, double spacing);

// Length of the polyline through the nodes, with the closing link where the path is closed.
double LengthOf(const NodePath& path, const Eigen::Matrix3Xd& nodes);

}  // namespace batten::internal
