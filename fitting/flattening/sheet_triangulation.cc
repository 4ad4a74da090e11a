// SPDX-License-Identifier: MIT
#include "fitting/flattening/sheet_triangulation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <optional>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "fitting/core/rounding.h"
#include "fitting/flattening/voronoi_weights.h"

namespace batten::internal {
namespace {

// Radians between two edges of the border, outside of the sheet: narrower notches are filled. The
// re-entrant corners of outlines are wider.
constexpr double kNotch = 75 * kOneDegree;
constexpr int kNotchRounds = 6;
constexpr size_t kFilledEdges = 12;  // edges of a hole that is a slip; real ones have more

using NodeTriangle = std::array<int, 3>;

NodeTriangle Rotated(int a, int b, int c) {  // the least node first
  if (a < b && a < c) return {a, b, c};
  return b < c ? NodeTriangle{b, c, a} : NodeTriangle{c, a, b};
}

double CircumradiusOf(const Eigen::Matrix3Xd& places, const NodeTriangle& t) {
  const Eigen::Vector3d a = places.col(t[1]) - places.col(t[0]),
                        b = places.col(t[2]) - places.col(t[0]),
                        c = places.col(t[2]) - places.col(t[1]);
  const double area = a.cross(b).norm();
  return area > 0 ? a.norm() * b.norm() * c.norm() / (2 * area) : HUGE_VAL;
}

// Triangles by their directed edges.
class SurfaceBuilder {
 public:
  bool Has(int from, int to) const { return across_.contains(Key(from, to)); }
  // The node opposite the edge in the triangle on its left.
  std::optional<int> Opposite(int from, int to) const {
    const auto found = across_.find(Key(from, to));
    if (found == across_.end()) return std::nullopt;
    return found->second;
  }
  bool Fits(const NodeTriangle& t) const {
    return !Has(t[0], t[1]) && !Has(t[1], t[2]) && !Has(t[2], t[0]);
  }
  void Add(const NodeTriangle& t) {
    for (int k = 0; k < 3; ++k) across_[Key(t[k], t[(k + 1) % 3])] = t[(k + 2) % 3];
  }
  void Remove(const NodeTriangle& t) {
    for (int k = 0; k < 3; ++k) across_.erase(Key(t[k], t[(k + 1) % 3]));
  }

  // The border edge that follows the border edge into `to` along the fan of its triangle.
  int NextOnBorder(int from, int to) const {
    int next = *Opposite(from, to);
    while (const std::optional<int> more = Opposite(next, to)) next = *more;
    return next;
  }

 private:
  static std::uint64_t Key(int from, int to) {
    return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(from)) << 32) |
           static_cast<std::uint32_t>(to);
  }
  std::unordered_map<std::uint64_t, int> across_;
};

struct Proposal {
  int votes;
  double radius;
  NodeTriangle triangle;
};

std::vector<Proposal> ProposalsOf(const SheetGraph& graph) {
  const PoissonDiskSamples& nodes = graph.nodes;
  const std::vector<std::vector<int>> rings = TwoRings(NeighboursOf(nodes.size(), graph.edges));
  std::map<NodeTriangle, int> votes;
  for (int i = 0; i < nodes.size(); ++i) {
    const VoronoiCell cell = VoronoiCellOf(nodes, i, rings[static_cast<size_t>(i)], kLargestCircle);
    const size_t count = cell.beyond.size();
    for (size_t k = 0; k < count; ++k) {
      const int a = cell.beyond[k], b = cell.beyond[(k + 1) % count];
      if (a >= 0 && b >= 0 && a != b) ++votes[Rotated(i, a, b)];
    }
  }
  std::vector<Proposal> proposals;
  for (const auto& [triangle, count] : votes)
    proposals.push_back({count, CircumradiusOf(nodes.places, triangle), triangle});
  std::sort(proposals.begin(), proposals.end(), [](const Proposal& a, const Proposal& b) {
    return std::tuple(-a.votes, a.radius, a.triangle) < std::tuple(-b.votes, b.radius, b.triangle);
  });
  return proposals;
}

std::vector<std::vector<int>> LoopsOf(const std::vector<NodeTriangle>& triangles,
                                      const SurfaceBuilder& surface) {
  std::map<std::pair<int, int>, bool> border;  // whether it has been walked along
  for (const NodeTriangle& t : triangles)
    for (int k = 0; k < 3; ++k)
      if (!surface.Has(t[(k + 1) % 3], t[k])) border[{t[k], t[(k + 1) % 3]}] = false;
  std::vector<std::vector<int>> loops;
  for (auto& [start, walked] : border) {
    if (walked) continue;
    std::vector<int>& loop = loops.emplace_back();
    for (std::pair<int, int> edge = start; !border[edge];) {
      border[edge] = true;
      loop.push_back(edge.first);
      edge = {edge.second, surface.NextOnBorder(edge.first, edge.second)};
    }
  }
  return loops;
}

// Fills a small hole by the triangles of least circles, one corner of it after the other.
void Fill(std::vector<int> loop,
          const Eigen::Matrix3Xd& places,
          std::vector<NodeTriangle>& triangles,
          SurfaceBuilder& surface) {
  while (loop.size() >= 3) {
    const size_t count = loop.size();
    double least = HUGE_VAL;
    size_t best = count;
    for (size_t k = 0; k < count; ++k) {
      // The hole is on the right of the loop: its triangles run against it.
      const NodeTriangle t = Rotated(loop[(k + 2) % count], loop[(k + 1) % count], loop[k]);
      const double radius = CircumradiusOf(places, t);
      if (radius < least && surface.Fits(t)) {
        least = radius;
        best = k;
      }
    }
    if (best == count) return;
    const NodeTriangle t = Rotated(loop[(best + 2) % count], loop[(best + 1) % count], loop[best]);
    surface.Add(t);
    triangles.push_back(t);
    if (count == 3) return;
    loop.erase(loop.begin() + static_cast<std::ptrdiff_t>((best + 1) % count));
  }
}

// Fills narrow notches of the borders. Whether there were any.
bool FillNotches(const PoissonDiskSamples& nodes,
                 std::vector<NodeTriangle>& triangles,
                 SurfaceBuilder& surface) {
  bool any = false;
  for (const std::vector<int>& loop : LoopsOf(triangles, surface)) {
    const size_t count = loop.size();
    for (size_t k = 0; k < count; ++k) {
      const int a = loop[k], b = loop[(k + 1) % count], c = loop[(k + 2) % count];
      const Eigen::Vector3d to_a = nodes.places.col(a) - nodes.places.col(b),
                            to_c = nodes.places.col(c) - nodes.places.col(b);
      const double angle = std::atan2(to_c.cross(to_a).dot(nodes.normals.col(b)), to_c.dot(to_a));
      if (!(angle > 0 && angle < kNotch)) continue;
      const NodeTriangle t = Rotated(c, b, a);
      if (!surface.Fits(t) || CircumradiusOf(nodes.places, t) > kLargestCircle * nodes.reach[b])
        continue;
      surface.Add(t);
      triangles.push_back(t);
      any = true;
      ++k;  // the border runs otherwise now
    }
  }
  return any;
}

// Keeps, of the fans around each node, the largest. Whether any other was there.
bool KeepOneFan(Eigen::Index nodes, std::vector<NodeTriangle>& triangles, SurfaceBuilder& surface) {
  std::vector<std::vector<int>> around(static_cast<size_t>(nodes));  // triangles
  for (size_t t = 0; t < triangles.size(); ++t)
    for (const int node : triangles[t])
      around[static_cast<size_t>(node)].push_back(static_cast<int>(t));
  std::vector<bool> gone(triangles.size(), false);
  bool any = false;
  for (int node = 0; node < nodes; ++node) {
    std::map<int, int> next;  // around the node: from a triangle's first other node to its second
    for (const int t : around[static_cast<size_t>(node)]) {
      const NodeTriangle& own = triangles[static_cast<size_t>(t)];
      const auto k = static_cast<size_t>(std::find(own.begin(), own.end(), node) - own.begin());
      next[own[(k + 1) % 3]] = own[(k + 2) % 3];
    }
    std::map<int, bool> seen;
    std::vector<std::vector<int>> fans;
    for (const auto& [start, end] : next) {
      bool is_first = true;  // no triangle of the fan before it; of closed fans any is
      for (const auto& [from, to] : next) is_first = is_first && to != start;
      if (!is_first) continue;
      std::vector<int>& fan = fans.emplace_back();
      for (int at = start; next.contains(at) && !seen[at]; at = next[at]) {
        seen[at] = true;
        fan.push_back(at);
      }
    }
    for (const auto& [start, end] : next) {
      if (seen[start]) continue;
      std::vector<int>& fan = fans.emplace_back();
      for (int at = start; !seen[at]; at = next[at]) {
        seen[at] = true;
        fan.push_back(at);
      }
    }
    if (fans.size() < 2) continue;
    any = true;
    const auto largest = std::max_element(
        fans.begin(), fans.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
    for (const int t : around[static_cast<size_t>(node)]) {
      const NodeTriangle& own = triangles[static_cast<size_t>(t)];
      const auto k = static_cast<size_t>(std::find(own.begin(), own.end(), node) - own.begin());
      if (std::find(largest->begin(), largest->end(), own[(k + 1) % 3]) == largest->end())
        gone[static_cast<size_t>(t)] = true;
    }
  }
  std::vector<NodeTriangle> kept;
  for (size_t t = 0; t < triangles.size(); ++t) {
    if (gone[t]) {
      surface.Remove(triangles[t]);
    } else {
      kept.push_back(triangles[t]);
    }
  }
  triangles = std::move(kept);
  return any;
}

// Keeps the triangles that hang together by edges with the most others.
void KeepLargestComponent(std::vector<NodeTriangle>& triangles, SurfaceBuilder& surface) {
  std::map<NodeTriangle, int> number;
  for (size_t t = 0; t < triangles.size(); ++t) number[triangles[t]] = static_cast<int>(t);
  std::vector<int> part(triangles.size(), -1);
  std::vector<int> sizes;
  for (size_t first = 0; first < triangles.size(); ++first) {
    if (part[first] >= 0) continue;
    const auto own = static_cast<int>(sizes.size());
    sizes.push_back(0);
    std::vector<size_t> front{first};
    part[first] = own;
    while (!front.empty()) {
      const NodeTriangle t = triangles[front.back()];
      front.pop_back();
      ++sizes[static_cast<size_t>(own)];
      for (int k = 0; k < 3; ++k) {
        const int from = t[(k + 1) % 3], to = t[k];
        const std::optional<int> opposite = surface.Opposite(from, to);
        if (!opposite) continue;
        const auto other = static_cast<size_t>(number.at(Rotated(from, to, *opposite)));
        if (part[other] >= 0) continue;
        part[other] = own;
        front.push_back(other);
      }
    }
  }
  if (sizes.size() < 2) return;
  const auto main = static_cast<int>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
  std::vector<NodeTriangle> kept;
  for (size_t t = 0; t < triangles.size(); ++t) {
    if (part[t] == main) {
      kept.push_back(triangles[t]);
    } else {
      surface.Remove(triangles[t]);
    }
  }
  triangles = std::move(kept);
}

}  // namespace

int SheetTriangulation::euler_characteristic() const {
  size_t border = 0;
  for (const std::vector<int>& loop : loops) border += loop.size();
  const size_t edges = (3 * triangles.size() + border) / 2;
  return vertices - static_cast<int>(edges) + static_cast<int>(triangles.size());
}

double BorderLength(const Eigen::Matrix3Xd& places, const std::vector<int>& loop) {
  double length = 0;
  for (size_t k = 0; k < loop.size(); ++k)
    length += (places.col(loop[(k + 1) % loop.size()]) - places.col(loop[k])).norm();
  return length;
}

SheetTriangulation TriangulateSheet(const SheetGraph& graph) {
  const Eigen::Matrix3Xd& places = graph.nodes.places;
  SheetTriangulation result;
  SurfaceBuilder surface;
  for (const Proposal& proposal : ProposalsOf(graph)) {
    if (!surface.Fits(proposal.triangle)) continue;
    surface.Add(proposal.triangle);
    result.triangles.push_back(proposal.triangle);
  }
  KeepLargestComponent(result.triangles, surface);
  while (KeepOneFan(graph.nodes.size(), result.triangles, surface))
    KeepLargestComponent(result.triangles, surface);
  for (int round = 0; round < kNotchRounds; ++round)
    if (!FillNotches(graph.nodes, result.triangles, surface)) break;
  const auto longest_first = [&](std::vector<std::vector<int>>& loops) {
    std::stable_sort(loops.begin(), loops.end(), [&](const auto& a, const auto& b) {
      return BorderLength(places, a) > BorderLength(places, b);
    });
  };
  std::vector<std::vector<int>> loops = LoopsOf(result.triangles, surface);
  longest_first(loops);
  for (size_t k = 1; k < loops.size(); ++k)
    if (loops[k].size() <= kFilledEdges) Fill(loops[k], places, result.triangles, surface);
  result.loops = LoopsOf(result.triangles, surface);
  longest_first(result.loops);
  std::vector<bool> used(static_cast<size_t>(graph.nodes.size()), false);
  for (const NodeTriangle& t : result.triangles)
    for (const int node : t) used[static_cast<size_t>(node)] = true;
  result.vertices = static_cast<int>(std::count(used.begin(), used.end(), true));
  return result;
}

}  // namespace batten::internal
