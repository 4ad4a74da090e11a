// SPDX-License-Identifier: MIT
#include "batten/fitting/faceted_solid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "batten/geometry/exact_shape.h"
#include "batten/geometry/triangle_samples.h"
#include "fitting/solid/triangle_topology.h"
#include "geometry/mesh/triangle_measure.h"
#include "geometry/numeric/number_text.h"
#include "geometry/numeric/polygon.h"

namespace batten {
using namespace internal;

namespace {

// Which plane each triangle is of: planes grow from the largest triangle that is left, and are
// fitted to what they have.
class PlaneGrower {
 public:
  PlaneGrower(const TriangleSurface& surface, const TriangleTopology& topology, double flat)
      : surface_(surface),
        topology_(topology),
        flat_(flat),
        face_of(std::size_t(topology.triangles()), -1) {
    std::vector<double> size(face_of.size());
    for (int t = 0; t < topology.triangles(); ++t)
      size[std::size_t(t)] = NormalOf(surface, t).norm();
    std::vector<int> order(face_of.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
      return size[std::size_t(a)] > size[std::size_t(b)];
    });
    for (const int seed : order) {
      if (face_of[std::size_t(seed)] < 0) Grow(seed);
    }
  }

 private:
  void Grow(int seed) {
    const int face = static_cast<int>(planes.size());
    std::vector<int> members, edge{seed};
    Eigen::Vector3d normal = Eigen::Vector3d::Zero(), moment = Eigen::Vector3d::Zero();
    PlaneShape plane{surface_.vertices.col(surface_.triangles(0, seed)),
                     NormalOf(surface_, seed).normalized()};
    if (plane.normal.isZero(0)) edge.clear();  // without area: a face by itself
    double weight = 0;
    // Another round while the plane that is fitted to all so far reaches farther.
    for (std::size_t before = 0;; before = members.size()) {
      std::vector<int> later;
      while (!edge.empty()) {
        const int t = edge.back();
        edge.pop_back();
        if (face_of[std::size_t(t)] >= 0) continue;
        const Eigen::Vector3d directed = NormalOf(surface_, t);
        if (!Lies(t, directed, plane)) {
          later.push_back(t);
          continue;
        }
        face_of[std::size_t(t)] = face;
        members.push_back(t);
        normal += directed;
        weight += directed.norm();
        for (int k = 0; k < 3; ++k) {
          moment += directed.norm() / 3 * surface_.vertices.col(surface_.triangles(k, t));
          edge.push_back(topology_.Twin(3 * t + k) / 3);
        }
      }
      if (members.size() == before || later.empty() || !(weight > 0)) break;
      plane = {moment / weight, normal.normalized()};
      edge = std::move(later);
    }
    face_of[std::size_t(seed)] = face;
    planes.push_back(plane);
  }

  bool Lies(int t, const Eigen::Vector3d& directed, const PlaneShape& plane) const {
    if (directed.dot(plane.normal) < 0) return false;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d p = surface_.vertices.col(surface_.triangles(k, t));
      if (!(std::abs((p - plane.point).dot(plane.normal)) <= flat_)) return false;
    }
    return true;
  }

  const TriangleSurface& surface_;
  const TriangleTopology& topology_;
  double flat_;

 public:
  std::vector<int> face_of;  // by triangle
  std::vector<PlaneShape> planes;
};

class FacetedBuilder {
 public:
  FacetedBuilder(const TriangleSurface& surface, double flat)
      : surface_(surface),
        topology_(surface),
        flat_(flat),
        grown_(surface, topology_, flat),
        corner_(std::size_t(topology_.vertices()), 0),
        edge_of_(std::size_t(topology_.half_edges()), -1) {}

  FacetedMesh Build() {
    MarkCorners();
    for (const PlaneShape& plane : grown_.planes) {
      TrimmedSolidFace face;
      face.carrier = plane;
      solid_.faces.push_back(face);
    }
    std::vector<char> seen(std::size_t(topology_.half_edges()), 0);
    for (int h = 0; h < topology_.half_edges(); ++h) {
      if (!Bounds(h) || !corner_[std::size_t(topology_.Origin(h))] || seen[std::size_t(h)])
        continue;
      std::vector<TrimmedSolidCoedge> loop;
      for (int at = h; !seen[std::size_t(at)];) {
        int last = at;
        seen[std::size_t(at)] = 1;
        while (!corner_[std::size_t(End(last))]) seen[std::size_t(last = Along(last))] = 1;
        loop.push_back(CoedgeOf(at, last));
        at = Along(last);
      }
      solid_.faces[std::size_t(FaceOf(h))].loops.push_back(std::move(loop));
    }
    TakeVertices();
    return {std::move(solid_), std::move(grown_.face_of)};
  }

 private:
  int FaceOf(int h) const { return grown_.face_of[std::size_t(h / 3)]; }
  bool Bounds(int h) const { return FaceOf(h) != FaceOf(topology_.Twin(h)); }
  int End(int h) const { return topology_.Origin(TriangleTopology::Next(h)); }

  // The half-edge that follows on the border of the same face.
  int Along(int h) const {
    int next = TriangleTopology::Next(h);
    while (!Bounds(next)) next = TriangleTopology::Next(topology_.Twin(next));
    return next;
  }

  double FromChord(int vertex, int from, int to) const {
    return DistanceFromSegment(
        surface_.vertices.col(vertex), surface_.vertices.col(from), surface_.vertices.col(to));
  }

  // Vertices where more than two borders meet, or one bends.
  void MarkCorners() {
    std::vector<int> borders(corner_.size(), 0);
    for (int h = 0; h < topology_.half_edges(); ++h) {
      borders[std::size_t(topology_.Origin(h))] += Bounds(h);
    }
    for (int h = 0; h < topology_.half_edges(); ++h) {
      if (!Bounds(h)) continue;
      const int vertex = End(h), next = Along(h);
      corner_[std::size_t(vertex)] |= borders[std::size_t(vertex)] != 2 ||
                                      FromChord(vertex, topology_.Origin(h), End(next)) > flat_;
    }
    // Bends too slight to count one by one may count together, and a loop has three corners.
    std::vector<char> seen(std::size_t(topology_.half_edges()), 0);
    for (int h = 0; h < topology_.half_edges(); ++h) {
      if (!Bounds(h) || seen[std::size_t(h)]) continue;
      std::vector<int> loop;
      for (int at = h; !seen[std::size_t(at)]; at = Along(at)) {
        seen[std::size_t(at)] = 1;
        loop.push_back(topology_.Origin(at));
      }
      KeepEnough(loop);
    }
  }

  void KeepEnough(const std::vector<int>& loop) {
    const auto is_corner = [&](int vertex) { return corner_[std::size_t(vertex)] != 0; };
    const auto first = std::find_if(loop.begin(), loop.end(), is_corner);
    if (std::count_if(loop.begin(), loop.end(), is_corner) < 3) {
      for (const int vertex : loop) corner_[std::size_t(vertex)] = 1;
      return;
    }
    std::vector<int> turned(first, loop.end());
    turned.insert(turned.end(), loop.begin(), first);
    turned.push_back(turned.front());
    for (std::size_t from = 0, to = 1; to < turned.size(); ++to) {
      if (!is_corner(turned[to])) continue;
      bool straight = true;
      for (std::size_t k = from + 1; k < to; ++k)
        straight = straight && FromChord(turned[k], turned[from], turned[to]) <= flat_;
      for (std::size_t k = from + 1; k < to && !straight; ++k) corner_[std::size_t(turned[k])] = 1;
      from = to;
    }
  }

  // Of the stretch of a border from `first` to `last`, which the face beyond has the other way
  // round.
  TrimmedSolidCoedge CoedgeOf(int first, int last) {
    const int other = edge_of_[std::size_t(topology_.Twin(last))];
    if (other >= 0) return {other, true};
    const int edge = static_cast<int>(solid_.edges.size());
    edge_of_[std::size_t(first)] = edge;
    const int start = topology_.Origin(first), end = End(last);
    const ExactLine line{surface_.vertices.col(start), surface_.vertices.col(end)};
    solid_.edges.push_back({ToNurbs(ExactCurve(line))});
    TrimmedSolidEdge& made = solid_.edges.back();
    made.exact.emplace(line);
    made.start = start;
    made.end = end;
    return {edge, false};
  }

  void TakeVertices() {
    std::vector<int> number(corner_.size(), -1), taken;
    const auto renumber = [&](int& vertex) {
      int& n = number[std::size_t(vertex)];
      if (n < 0) {
        n = static_cast<int>(taken.size());
        taken.push_back(vertex);
      }
      vertex = n;
    };
    for (TrimmedSolidEdge& edge : solid_.edges) {
      renumber(edge.start);
      renumber(edge.end);
    }
    solid_.vertices = surface_.vertices(Eigen::all, taken);
  }

  const TriangleSurface& surface_;
  const TriangleTopology topology_;
  double flat_;
  PlaneGrower grown_;
  std::vector<char> corner_;  // by vertex
  std::vector<int> edge_of_;  // by the half-edge with which it starts
  TrimmedSolid solid_;
};

}  // namespace

FacetedMesh FacetedSolid(const TriangleSurface& closed, double flat) {
  return FacetedBuilder(closed, flat).Build();
}

double SinglePrecisionOf(const Eigen::Matrix3Xd& vertices) {
  if (vertices.cols() == 0) return 0;
  return 4 * double(std::numeric_limits<float>::epsilon()) * vertices.cwiseAbs().maxCoeff();
}

MeshVolume VolumeOf(const TriangleSurface& closed) {
  constexpr double kKept = 0.002;  // level: what docs/guide.md promises
  // Over triangles of corners on a sphere the mean gap is at most so many chord heights: those with
  // a right angle have it.
  constexpr double kMeanGap = 4.0 / 3;
  if (closed.vertices.cols() == 0) return {};
  const Eigen::Vector3d middle = closed.vertices.rowwise().mean();
  double six = 0;
  for (Eigen::Index t = 0; t < closed.triangles.cols(); ++t) {
    six += (closed.vertices.col(closed.triangles(0, t)) - middle).dot(NormalOf(closed, t));
  }
  return {six / 6, std::max(kKept * six / 6, kMeanGap * AreaOf(closed) * ChordHeight(closed))};
}

std::optional<Doubt> VolumeDoubt(double volume, const MeshVolume& mesh) {
  if (std::abs(volume - mesh.volume) <= mesh.margin) return std::nullopt;
  return Doubt{
      "volume",
      "its volume is " + RoundedText(volume) + ", that of the mesh " + RoundedText(mesh.volume)};
}

}  // namespace batten
