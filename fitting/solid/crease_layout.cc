// SPDX-License-Identifier: MIT
#include "fitting/solid/crease_layout.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include "batten/fitting/refused_data.h"
#include "fitting/solid/quad_improver.h"
#include "fitting/solid/triangle_topology.h"
#include "geometry/mesh/triangle_measure.h"
#include "geometry/subdivision/quad_topology.h"

namespace batten::internal {
namespace {

Eigen::Vector3d MiddleOf(const QuadMesh& layout, int face) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const int v : layout.faces.col(face)) middle += layout.vertices.col(v) / 4;
  return middle;
}

int PartsOf(const QuadTopology& mesh) { return 1 + std::ranges::max(mesh.SmoothParts()); }

class CreaseLayer {
 public:
  CreaseLayer(QuadMesh layout,
              const TriangleSurface& surface,
              const SurfaceCreases& creases,
              const SurfaceProjector& projector)
      : layout_(std::move(layout)),
        surface_(surface),
        creases_(creases),
        projector_(projector),
        topology_(layout_),
        fixed_(std::size_t(topology_.vertices()), 0) {}

  QuadMesh Lay(int rounds) && {
    TakeCorners();
    for (int v = 0; v < topology_.vertices(); ++v) Straighten(v);
    TakeTurns();
    for (int v = 0; v < topology_.vertices(); ++v) {
      if (topology_.Creases(v) == 0 || fixed_[std::size_t(v)]) continue;
      Place(v, NearestOnCreases(surface_, creases_, layout_.vertices.col(v)));
    }
    for (int round = 0; round < rounds; ++round) {
      for (int v = 0; v < topology_.vertices(); ++v) Move(v);
    }
    return std::move(layout_);
  }

 private:
  void Place(int v, const Eigen::Vector3d& at) { layout_.vertices.col(v) = at; }

  // Every corner of the surface is that vertex of the layout's creases which is nearest, with as
  // many creases if there is one within the length of a face.
  void TakeCorners() {
    std::vector<int> degree(creases_.corner.size(), 0);
    for (const auto& [a, b] : creases_.edges) ++degree[std::size_t(a)], ++degree[std::size_t(b)];
    const double length = std::sqrt(AreaOf(surface_) / topology_.faces());
    std::vector<std::tuple<double, int, int>> pairs;  // cost, corner, vertex
    for (int c = 0; c < int(degree.size()); ++c) {
      if (!creases_.corner[std::size_t(c)]) continue;
      for (int v = 0; v < topology_.vertices(); ++v) {
        if (topology_.Creases(v) == 0) continue;
        const double distance = (layout_.vertices.col(v) - surface_.vertices.col(c)).norm();
        constexpr double kFar = 2;
        if (distance > kFar * length) continue;
        const int other = std::abs(topology_.Creases(v) - degree[std::size_t(c)]);
        pairs.emplace_back(distance + other * length, c, v);
      }
    }
    std::sort(pairs.begin(), pairs.end());
    std::vector<char> taken(degree.size(), 0);
    for (const auto& [cost, c, v] : pairs) {
      if (taken[std::size_t(c)] || fixed_[std::size_t(v)]) continue;
      taken[std::size_t(c)] = fixed_[std::size_t(v)] = 1;
      Place(v, surface_.vertices.col(c));
      layout_.corners.push_back(v);
    }
  }

  // The face that is alone between two creases at a vertex which is no corner: where a crease
  // passes from one line of the grid to the next; −1: none.
  int LoneFace(int v) const {
    if (topology_.Creases(v) != 2 || fixed_[std::size_t(v)]) return -1;
    int h = topology_.Outgoing(v);
    for (int k = 0; k < topology_.Valence(v); ++k, h = topology_.Turned(h)) {
      if (topology_.FanOf(h).sectors == 1) return h >> 2;
    }
    return -1;
  }

  int LoneFaces() const {
    int count = 0;
    for (int v = 0; v < topology_.vertices(); ++v) count += LoneFace(v) >= 0;
    return count;
  }

  // Gives faces along the line from a vertex to the other side of the crease, while that moves the
  // passage on to where it meets one that leads back. What creases part stays parted.
  void Straighten(int v) {
    constexpr int kFar = 30;  // faces
    const QuadTopology before = topology_;
    const int count = LoneFaces();
    for (int step = 0; step < kFar && v >= 0; ++step) {
      const int face = LoneFace(v);
      if (face < 0) break;
      const auto corners = layout_.faces.col(face);
      if (std::any_of(
              corners.begin(), corners.end(), [&](int c) { return fixed_[std::size_t(c)]; }))
        break;
      std::vector<char> creases(std::size_t(topology_.half_edges()));
      for (int h = 0; h < topology_.half_edges(); ++h)
        creases[std::size_t(h)] = topology_.IsCrease(h);
      for (int h = 4 * face; h < 4 * face + 4; ++h) {
        creases[std::size_t(h)] ^= 1;
        creases[std::size_t(topology_.Twin(h))] ^= 1;
      }
      topology_ = QuadTopology(layout_.faces, creases, topology_.corner_marks());
      if (LoneFaces() < count) {
        if (PartsOf(topology_) < PartsOf(before)) break;
        return TakeCreases();
      }
      // On along the line: the corner of the face that is the passage now, on the same side.
      int next = -1;
      for (const int c : corners) {
        if (c != v && LoneFace(c) >= 0 && LoneFace(c) != face) next = c;
      }
      v = next;
    }
    topology_ = before;
  }

  void TakeCreases() {
    layout_.creases.resize(2, 0);
    for (int h = 0; h < topology_.half_edges(); ++h) {
      if (!topology_.IsCrease(h) || topology_.Twin(h) < h) continue;
      layout_.creases.conservativeResize(2, layout_.creases.cols() + 1);
      layout_.creases.rightCols(1) << topology_.Origin(h), topology_.Origin(QuadTopology::Next(h));
    }
  }

  // A curve that goes on smoothly through the corner of a single face would leave that without a
  // tangent plane.
  void TakeTurns() {
    for (int v = 0; v < topology_.vertices(); ++v) {
      if (LoneFace(v) >= 0) layout_.corners.push_back(v);
    }
  }

  // A share of the way to the middle, if no face becomes uneven.
  void Move(int v) {
    if (fixed_[std::size_t(v)] || topology_.Creases(v) == 1 || topology_.Creases(v) > 2) return;
    const bool along = topology_.Creases(v) == 2;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    double count = 0;
    int h = topology_.Outgoing(v);
    for (int k = 0; k < topology_.Valence(v); ++k, h = topology_.Turned(h)) {
      if (along && !topology_.IsCrease(h)) continue;
      middle += along
                    ? Eigen::Vector3d(layout_.vertices.col(topology_.Origin(QuadTopology::Next(h))))
                    : MiddleOf(layout_, h >> 2);
      ++count;
    }
    const Eigen::Vector3d at = layout_.vertices.col(v);
    const Eigen::Vector3d wanted = at + kShareOfWay * (middle / count - at);
    const double before = LeastAbout(v);
    Place(v, along ? NearestOnCreases(surface_, creases_, wanted) : projector_.Nearest(wanted));
    if (LeastAbout(v) < std::min(before, kFairSquareness)) Place(v, at);
  }

  double LeastAbout(int v) const {
    double least = 1;
    int h = topology_.Outgoing(v);
    for (int k = 0; k < topology_.Valence(v); ++k, h = topology_.Turned(h)) {
      const auto corner = layout_.faces.col(h >> 2);
      least = std::min(least,
                       Squareness(layout_.vertices, {corner[0], corner[1], corner[2], corner[3]}));
    }
    return least;
  }

  QuadMesh layout_;
  const TriangleSurface& surface_;
  const SurfaceCreases& creases_;
  const SurfaceProjector& projector_;
  QuadTopology topology_;
  std::vector<char> fixed_;
};

// Which faces lie on one side, within a distance of a place.
class LocalSides {
 public:
  LocalSides(const TriangleSurface& surface, const SurfaceCreases& creases)
      : surface_(surface),
        topology_(surface),
        creases_(CreasesByHalfEdge(topology_, creases)),
        seen_(std::size_t(topology_.triangles()), 0) {}

  // Whether one triangle leads to the other over triangles near a place without crossing a crease.
  bool Joined(int from, int to, const Eigen::Vector3d& at, double distance) {
    std::vector<int> open = {from}, touched = {from};
    seen_[std::size_t(from)] = 1;
    bool found = from == to;
    while (!open.empty() && !found) {
      const int t = open.back();
      open.pop_back();
      for (int h = 3 * t; h < 3 * t + 3; ++h) {
        const int beside = topology_.Twin(h) / 3;
        if (creases_[std::size_t(h)] || seen_[std::size_t(beside)]) continue;
        const Eigen::Vector3d place = NearestOnTriangle(surface_, beside, at);
        if ((place - at).norm() > distance) continue;
        seen_[std::size_t(beside)] = 1;
        touched.push_back(beside);
        open.push_back(beside);
        found = found || beside == to;
      }
    }
    for (const int t : touched) seen_[std::size_t(t)] = 0;
    return found;
  }

 private:
  const TriangleSurface& surface_;
  TriangleTopology topology_;
  std::vector<char> creases_, seen_;
};

}  // namespace

QuadMesh OntoCreases(QuadMesh layout,
                     const TriangleSurface& surface,
                     const SurfaceCreases& creases,
                     const SurfaceProjector& projector,
                     int rounds) {
  return CreaseLayer(std::move(layout), surface, creases, projector).Lay(rounds);
}

void RefuseUneven(const QuadMesh& layout) {
  // Where a crease passes from one line of the grid to the next it goes straight through the corner
  // of a face.
  constexpr double kStraight = -0.3;
  std::vector<char> cap(std::size_t(layout.faces.cols()), 0);
  for (const int f : layout.caps) cap[std::size_t(f)] = 1;
  for (int f = 0; f < layout.faces.cols(); ++f) {
    const auto face = layout.faces.col(f);
    if (!cap[std::size_t(f)] &&
        Squareness(layout.vertices, {face[0], face[1], face[2], face[3]}) < kStraight)
      throw RefusedData("a face is too uneven");
  }
}

int TriangleUnder(const QuadMesh& layout, int face, const SurfaceProjector& projector) {
  const auto corner = layout.faces.col(face);
  const Eigen::Vector3d one = layout.vertices.col(corner[2]) - layout.vertices.col(corner[0]);
  const Eigen::Vector3d two = layout.vertices.col(corner[3]) - layout.vertices.col(corner[1]);
  return projector.TriangleNear(MiddleOf(layout, face), one.cross(two));
}

Eigen::Matrix2Xi CreasesBetweenFaces(const QuadMesh& layout,
                                     const TriangleSurface& surface,
                                     const SurfaceCreases& creases) {
  const QuadTopology mesh(layout);
  const SurfaceProjector projector(surface);
  LocalSides sides(surface, creases);
  std::vector<int> triangle;
  Eigen::Matrix3Xd middles(3, mesh.faces());
  for (int f = 0; f < mesh.faces(); ++f) {
    middles.col(f) = MiddleOf(layout, f);
    triangle.push_back(TriangleUnder(layout, f, projector));
  }
  Eigen::Matrix2Xi found(2, 0);
  for (int h = 0; h < mesh.half_edges(); ++h) {
    const int twin = mesh.Twin(h);
    if (twin < h) continue;
    const int f = h >> 2, g = twin >> 2;
    const Eigen::Vector3d a = layout.vertices.col(mesh.Origin(h));
    const Eigen::Vector3d b = layout.vertices.col(mesh.Origin(QuadTopology::Next(h)));
    constexpr double kAbout = 0.75;  // of the distance of the middles, from the edge's own
    const double distance =
        kAbout * std::max((middles.col(f) - middles.col(g)).norm(), (a - b).norm());
    if (sides.Joined(triangle[std::size_t(f)], triangle[std::size_t(g)], (a + b) / 2, distance)) {
      continue;
    }
    found.conservativeResize(2, found.cols() + 1);
    found.rightCols(1) << mesh.Origin(h), mesh.Origin(QuadTopology::Next(h));
  }
  return found;
}

}  // namespace batten::internal
