// SPDX-License-Identifier: MIT
// The flag complex of a sheet's graph: nodes, edges, and a triangle where three nodes are
// neighbours of each other.
#pragma once

#include <array>
#include <functional>
#include <queue>
#include <utility>
#include <vector>

#include "fitting/flattening/planar_edges.h"
#include "geometry/numeric/constants.h"

namespace batten::internal {

struct FlagComplex {
  FlagComplex(std::size_t nodes, const std::vector<PlanarEdge>& edges);

  using Triangle = std::array<int, 3>;  // edges ab, bc, ac with a < b < c

  std::vector<std::vector<std::pair<int, int>>> next;  // of a node, ascending: neighbour and edge
  std::vector<double> lengths;                         // of edges
  std::vector<Triangle> triangles;
  std::vector<std::vector<int>> around;  // triangles of an edge
};

// Shortest ways from one node over edges, by Dijkstra's algorithm. Keeps a reference.
class ShortestWays {
 public:
  explicit ShortestWays(const FlagComplex& complex)
      : complex_(complex),
        distance_(complex.next.size(), kInfinity),
        before_(complex.next.size(), {-1, -1}) {}

  // Over the edges that `usable` lets pass, to nodes no farther than `farthest`, until `goal` is
  // reached; −1: to all.
  template <typename Usable>
  void Search(int from, int goal, double farthest, const Usable& usable) {
    for (const int node : touched_) distance_[node] = kInfinity;
    touched_ = {from};
    distance_[from] = 0;
    before_[from] = {-1, -1};
    using Entry = std::pair<double, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> front;
    front.emplace(0, from);
    while (!front.empty()) {
      const auto [distance, node] = front.top();
      front.pop();
      if (node == goal) return;
      if (distance > distance_[node]) continue;
      for (const auto& [other, edge] : complex_.next[node]) {
        if (!usable(edge)) continue;
        const double way = distance + complex_.lengths[edge];
        if (way > farthest || way >= distance_[other]) continue;
        if (distance_[other] == kInfinity) touched_.push_back(other);
        distance_[other] = way;
        before_[other] = {node, edge};
        front.emplace(way, other);
      }
    }
  }

  // As the last search found it; kInfinity: not reached.
  double Distance(int node) const { return distance_[node]; }
  // Of a node that was reached: the one before it and the edge between; −1: none.
  const std::pair<int, int>& Before(int node) const { return before_[node]; }

 private:
  const FlagComplex& complex_;
  std::vector<double> distance_;
  std::vector<std::pair<int, int>> before_;
  std::vector<int> touched_;
};

}  // namespace batten::internal
