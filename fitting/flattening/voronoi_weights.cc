// SPDX-License-Identifier: MIT
#include "fitting/flattening/voronoi_weights.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

namespace batten::internal {
namespace {

constexpr int kSides = 16;  // of the polygon that cells are cut from
constexpr double kLeastWeight = 1e-3;

VoronoiCell RoundCell(double radius) {
  VoronoiCell cell;
  for (int k = 0; k < kSides; ++k) {
    const double angle = 2 * std::numbers::pi * k / kSides;
    cell.corners.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    cell.beyond.push_back(-1);
  }
  return cell;
}

// Clips off the part of the cell nearer to q than to the origin.
void CutOff(VoronoiCell& cell, const Eigen::Vector2d& q, int neighbour) {
  const double middle = q.squaredNorm() / 2;
  VoronoiCell rest;
  const size_t count = cell.corners.size();
  for (size_t k = 0; k < count; ++k) {
    const Eigen::Vector2d &a = cell.corners[k], &b = cell.corners[(k + 1) % count];
    const double over_a = a.dot(q) - middle, over_b = b.dot(q) - middle;
    if (over_a <= 0) {
      rest.corners.push_back(a);
      rest.beyond.push_back(cell.beyond[k]);
    }
    if ((over_a <= 0) == (over_b <= 0)) continue;
    rest.corners.emplace_back(a + (b - a) * (over_a / (over_a - over_b)));
    rest.beyond.push_back(over_a <= 0 ? neighbour : cell.beyond[k]);
  }
  cell = std::move(rest);
}

}  // namespace

VoronoiCell VoronoiCellOf(const PoissonDiskSamples& nodes,
                          int i,
                          const std::vector<int>& around,
                          double radius) {
  VoronoiCell cell = RoundCell(radius * nodes.reach[i]);
  const Eigen::Vector3d tangent = nodes.tangents.col(i), binormal = nodes.Binormal(i);
  std::vector<std::pair<double, int>> ring;  // near ones first: the cell is soon small
  for (const int j : around) {
    if (j != i) ring.emplace_back((nodes.places.col(j) - nodes.places.col(i)).norm(), j);
  }
  std::sort(ring.begin(), ring.end());
  for (const auto& [distance, j] : ring) {
    const Eigen::Vector3d way = nodes.places.col(j) - nodes.places.col(i);
    Eigen::Vector2d q(way.dot(tangent), way.dot(binormal));
    const double size = q.norm();
    if (size > 0) CutOff(cell, q * (distance / size), j);
  }
  return cell;
}

std::vector<SheetOutline> VoronoiEdgeWeights(const SheetGraph& graph) {
  const PoissonDiskSamples& nodes = graph.nodes;
  const std::vector<std::vector<int>> rings =
      TwoRings(NeighboursOf(graph.nodes.size(), graph.edges));
  std::vector<std::tuple<int, int, double>> halves;
  for (int i = 0; i < nodes.size(); ++i) {
    const VoronoiCell cell = VoronoiCellOf(nodes, i, rings[i], kLargestCircle);
    for (size_t k = 0; k < cell.corners.size(); ++k) {
      const int j = cell.beyond[k];
      if (j < 0) continue;
      const double border = (cell.corners[(k + 1) % cell.corners.size()] - cell.corners[k]).norm();
      const double weight = border / (2 * (nodes.places.col(j) - nodes.places.col(i)).norm());
      halves.emplace_back(std::min(i, j), std::max(i, j), weight);
    }
  }
  for (const auto& [i, j] : graph.edges) halves.emplace_back(i, j, kLeastWeight);
  std::sort(halves.begin(), halves.end());
  std::vector<SheetOutline> borders;
  for (const auto& [i, j, weight] : halves) {
    if (borders.empty() || borders.back().first != i || borders.back().second != j) {
      borders.push_back({i, j, 0});
    }
    borders.back().weight += weight;
  }
  return borders;
}

}  // namespace batten::internal
