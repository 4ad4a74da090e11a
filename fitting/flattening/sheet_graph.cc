// SPDX-License-Identifier: MIT
#include "fitting/flattening/sheet_graph.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "batten/fitting/neighbours.h"
#include "fitting/neighbours/signed_sets.h"

namespace batten::internal {
namespace {

bool Follows(const PoissonDiskSamples& nodes, int i, int j, const SheetGraphOptions& options) {
  const Eigen::Vector3d edge = nodes.places.col(j) - nodes.places.col(i);
  const double length = edge.norm();
  return length > 0 && length < options.longest * std::min(nodes.reach[i], nodes.reach[j]) &&
         std::abs(edge.dot(nodes.normals.col(i))) < options.steepest * length &&
         std::abs(edge.dot(nodes.normals.col(j))) < options.steepest * length &&
         std::abs(nodes.normals.col(i).dot(nodes.normals.col(j))) > options.least_cosine;
}

std::vector<SheetEdge> EdgesOf(const PoissonDiskSamples& nodes, const SheetGraphOptions& options) {
  const int looked_at = 2 * options.neighbours + 1;
  const std::vector<int> near = NeighbourIndex(nodes.places).Nearest(nodes.places, looked_at);
  const auto each = static_cast<int>(static_cast<Eigen::Index>(near.size()) / nodes.size());
  std::vector<SheetEdge> edges;
  for (int i = 0; i < nodes.size(); ++i) {
    int asked = 0;
    for (int j = 0; j < each && asked < options.neighbours; ++j) {
      const int other = near[i * each + j];
      if (other == i || !Follows(nodes, i, other, options)) continue;
      edges.push_back({std::min(i, other), std::max(i, other)});
      ++asked;
    }
  }
  const auto key = [](const SheetEdge& e) { return std::pair(e.first, e.second); };
  std::sort(
      edges.begin(), edges.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
  const auto same = [&](const auto& a, const auto& b) { return key(a) == key(b); };
  edges.erase(std::unique(edges.begin(), edges.end(), same), edges.end());
  return edges;
}

// Flattest edges first.
SignedSets SpanningTrees(const PoissonDiskSamples& nodes, const std::vector<SheetEdge>& edges) {
  std::vector<std::tuple<double, int, int>> order;
  order.reserve(edges.size());
  const auto cosine = [&](int i, int j) { return nodes.normals.col(i).dot(nodes.normals.col(j)); };
  for (const auto& [i, j] : edges) order.emplace_back(1 - std::abs(cosine(i, j)), i, j);
  std::sort(order.begin(), order.end());
  SignedSets sets(nodes.size());
  for (const auto& [weight, i, j] : order) sets.Join(i, j, cosine(i, j) < 0 ? 1 : 0);
  return sets;
}

}  // namespace

SheetGraph ConnectSheet(const PoissonDiskSamples& nodes, const SheetGraphOptions& options) {
  const std::vector<SheetEdge> edges = EdgesOf(nodes, options);
  SignedSets sets = SpanningTrees(nodes, edges);
  std::vector<int> members(static_cast<size_t>(nodes.size()), 0);
  for (int i = 0; i < nodes.size(); ++i) ++members[sets.Find(i).first];
  const auto main =
      static_cast<int>(std::max_element(members.begin(), members.end()) - members.begin());
  std::vector<Eigen::Index> kept;
  std::vector<int> rank(static_cast<size_t>(nodes.size()), -1);
  for (int i = 0; i < nodes.size(); ++i) {
    if (sets.Find(i).first != main) continue;
    rank[i] = static_cast<int>(kept.size());
    kept.push_back(i);
  }
  SheetGraph graph{nodes.Picked(kept), {}, {}, 0};
  graph.share = static_cast<double>(kept.size()) / static_cast<double>(nodes.size());
  for (const Eigen::Index i : kept) {
    if (sets.Find(static_cast<int>(i)).second != 0) graph.nodes.Flip(rank[i]);
  }
  for (const auto& [i, j] : edges) {
    if (rank[i] < 0) continue;
    const double cosine = graph.nodes.normals.col(rank[i]).dot(graph.nodes.normals.col(rank[j]));
    (cosine > 0 ? graph.edges : graph.contradictions).push_back({rank[i], rank[j]});
  }
  return graph;
}

std::vector<std::vector<int>> NeighboursOf(Eigen::Index nodes,
                                           const std::vector<SheetEdge>& edges) {
  std::vector<std::vector<int>> neighbours(static_cast<size_t>(nodes));
  for (const auto& [i, j] : edges) {
    neighbours[i].push_back(j);
    neighbours[j].push_back(i);
  }
  for (auto& list : neighbours) std::sort(list.begin(), list.end());
  return neighbours;
}

std::vector<std::vector<int>> TwoRings(const std::vector<std::vector<int>>& neighbours) {
  std::vector<std::vector<int>> rings(neighbours.size());
  for (size_t i = 0; i < neighbours.size(); ++i) {
    rings[i] = {static_cast<int>(i)};
    for (const int j : neighbours[i]) {
      rings[i].push_back(j);
      rings[i].insert(rings[i].end(), neighbours[j].begin(), neighbours[j].end());
    }
    std::sort(rings[i].begin(), rings[i].end());
    rings[i].erase(std::unique(rings[i].begin(), rings[i].end()), rings[i].end());
  }
  return rings;
}

}  // namespace batten::internal
