// SPDX-License-Identifier: MIT
// Alone in its translation unit, and C++17: LEMON 1.3 calls members of std::allocator that C++20
// took away.
#include "fitting/solid/matching_kernel.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"
#include <lemon/matching.h>
#include <lemon/smart_graph.h>
#pragma GCC diagnostic pop

namespace batten::internal {

std::vector<int> PerfectMatching(int nodes,
                                 const std::vector<std::array<int, 2>>& edges,
                                 const std::vector<int>& weights) {
  lemon::SmartGraph graph;
  std::vector<lemon::SmartGraph::Node> node;
  for (int k = 0; k < nodes; ++k) node.push_back(graph.addNode());
  lemon::SmartGraph::EdgeMap<int> weight(graph);
  for (std::size_t k = 0; k < edges.size(); ++k) {
    const auto edge = graph.addEdge(node[std::size_t(edges[k][0])], node[std::size_t(edges[k][1])]);
    weight[edge] = weights[k];
  }
  lemon::MaxWeightedPerfectMatching<lemon::SmartGraph, lemon::SmartGraph::EdgeMap<int>> matching(
      graph, weight);
  std::vector<int> chosen;
  if (!matching.run()) return chosen;
  for (int k = 0; k < int(edges.size()); ++k) {
    if (matching.matching(lemon::SmartGraph::edgeFromId(k))) chosen.push_back(k);
  }
  return chosen;
}

}  // namespace batten::internal
