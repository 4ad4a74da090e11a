// SPDX-License-Identifier: MIT
#include "fitting/solid/cap_borders.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <stdexcept>
#include <utility>

#include "batten/fitting/refused_data.h"
#include "fitting/solid/crease_layout.h"
#include "fitting/solid/surface_projector.h"
#include "fitting/solid/triangle_topology.h"
#include "geometry/mesh/triangle_measure.h"
#include "geometry/subdivision/quad_topology.h"

namespace batten::internal {
namespace {

// The part of every triangle: those beside one another that are alike.
std::vector<int> PartsOf(const TriangleTopology& topology, const std::vector<char>& caps) {
  std::vector<int> part(caps.size(), -1);
  int count = 0;
  for (int first = 0; first < topology.triangles(); ++first) {
    if (part[std::size_t(first)] >= 0) continue;
    std::vector<int> open = {first};
    part[std::size_t(first)] = count;
    while (!open.empty()) {
      const int t = open.back();
      open.pop_back();
      for (int h = 3 * t; h < 3 * t + 3; ++h) {
        const int beside = topology.Twin(h) / 3;
        if (part[std::size_t(beside)] >= 0 || caps[std::size_t(t)] != caps[std::size_t(beside)])
          continue;
        part[std::size_t(beside)] = count;
        open.push_back(beside);
      }
    }
    ++count;
  }
  return part;
}

void TakeMajority(const TriangleTopology& topology, std::vector<char>& caps) {
  constexpr int kRounds = 6;
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<char> before = caps;
    for (int t = 0; t < topology.triangles(); ++t) {
      int beside = 0;
      for (int h = 3 * t; h < 3 * t + 3; ++h) beside += before[std::size_t(topology.Twin(h) / 3)];
      caps[std::size_t(t)] = beside >= 2;
    }
  }
}

// Small parts become what is about them, those first that have none smaller beside them.
void DropSmall(const TriangleSurface& surface,
               const TriangleTopology& topology,
               std::vector<char>& caps) {
  constexpr double kLeast = 0.01;
  const double least = kLeast * AreaOf(surface);
  for (bool more = true; more;) {
    const std::vector<int> part = PartsOf(topology, caps);
    std::vector<double> areas(std::size_t(std::ranges::max(part)) + 1, 0.0);
    for (int t = 0; t < topology.triangles(); ++t)
      areas[std::size_t(part[std::size_t(t)])] += NormalOf(surface, t).norm() / 2;
    if (areas.size() == 1) return;
    std::vector<char> drops(areas.size());
    for (std::size_t k = 0; k < areas.size(); ++k) drops[k] = areas[k] < least;
    for (int h = 0; h < topology.half_edges(); ++h) {
      const int one = part[std::size_t(h / 3)], other = part[std::size_t(topology.Twin(h) / 3)];
      if (std::pair(areas[std::size_t(other)], other) < std::pair(areas[std::size_t(one)], one))
        drops[std::size_t(one)] = 0;
    }
    more = std::ranges::count(drops, 1) > 0;
    for (std::size_t t = 0; t < part.size(); ++t) caps[t] ^= drops[std::size_t(part[t])];
  }
}

std::vector<int> BordersOf(const TriangleTopology& topology, const std::vector<char>& caps) {
  std::vector<int> borders;
  for (int h = 0; h < topology.half_edges(); ++h) {
    if (caps[std::size_t(h / 3)] && !caps[std::size_t(topology.Twin(h) / 3)]) borders.push_back(h);
  }
  return borders;
}

}  // namespace

TriangleSurface WithEvenCaps(TriangleSurface surface) {
  constexpr int kRounds = 20;
  if (surface.caps.empty()) return surface;
  if (std::ssize(surface.caps) != surface.triangles.cols())
    throw std::invalid_argument("the surface's caps are not one mark a triangle");
  const TriangleTopology topology(surface);
  TakeMajority(topology, surface.caps);
  DropSmall(surface, topology, surface.caps);
  const std::vector<int> borders = BordersOf(topology, surface.caps);
  if (borders.empty()) {
    surface.caps.clear();
    return surface;
  }
  std::map<int, std::vector<int>> beside;
  for (const int h : borders) {
    const int a = topology.Origin(h), b = topology.Origin(TriangleTopology::Next(h));
    beside[a].push_back(b);
    beside[b].push_back(a);
  }
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::Matrix3Xd before = surface.vertices;
    for (const auto& [v, others] : beside) {
      if (others.size() != 2) continue;
      surface.vertices.col(v) =
          (2 * before.col(v) + before.col(others[0]) + before.col(others[1])) / 4;
    }
  }
  return surface;
}

SurfaceCreases WithCapBorders(SurfaceCreases creases, const TriangleSurface& surface) {
  if (surface.caps.empty()) return creases;
  const TriangleTopology topology(surface);
  const std::vector<char> marks = CreasesByHalfEdge(topology, creases);
  const auto cap = [&](int h) { return surface.caps[std::size_t(h / 3)] != 0; };
  SurfaceCreases with;
  std::vector<int> degree(std::size_t(topology.vertices()), 0), border = degree;
  for (int h = 0; h < topology.half_edges(); ++h) {
    if (topology.Twin(h) < h) continue;
    const bool one = cap(h), other = cap(topology.Twin(h));
    if (one == other && (one || !marks[std::size_t(h)])) continue;
    const int a = topology.Origin(h), b = topology.Origin(TriangleTopology::Next(h));
    with.edges.push_back({std::min(a, b), std::max(a, b)});
    for (const int v : {a, b}) {
      ++degree[std::size_t(v)];
      border[std::size_t(v)] += one != other;
    }
  }
  // Borders have been smoothed: what corners they had are where creases meet them.
  with.corner.assign(degree.size(), 0);
  for (std::size_t v = 0; v < degree.size(); ++v) {
    const bool along = degree[v] == 2 && border[v] == 2;
    const bool smooth = degree[v] == 2 && border[v] == 0 && !creases.none() && !creases.corner[v];
    with.corner[v] = degree[v] > 0 && !along && !smooth;
  }
  return with;
}

std::vector<int> CapFaces(const QuadMesh& layout, const TriangleSurface& surface) {
  constexpr double kSure = 0.8;
  const QuadTopology mesh(layout);
  const SurfaceProjector projector(surface);
  const std::vector<int> part = mesh.SmoothParts();
  std::map<int, std::pair<int, int>> votes;  // of each part: for a cap, and all
  for (int f = 0; f < mesh.faces(); ++f) {
    auto& [caps, all] = votes[part[std::size_t(f)]];
    caps += surface.caps[std::size_t(TriangleUnder(layout, f, projector))];
    ++all;
  }
  std::vector<int> faces;
  for (int f = 0; f < mesh.faces(); ++f) {
    const auto& [caps, all] = votes[part[std::size_t(f)]];
    if (caps > (1 - kSure) * all && caps < kSure * all)
      throw RefusedData("the layout does not follow the border of the points");
    if (2 * caps > all) faces.push_back(f);
  }
  if (faces.empty() || int(faces.size()) == mesh.faces())
    throw RefusedData("the layout has no faces on one side of the border of the points");
  return faces;
}

}  // namespace batten::internal
