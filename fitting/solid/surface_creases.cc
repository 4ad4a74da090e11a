// SPDX-License-Identifier: MIT
#include "fitting/solid/surface_creases.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "fitting/solid/triangle_topology.h"

namespace batten::internal {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// Normals of triangles, less their noise.
Eigen::Matrix3Xd MeanNormals(const TriangleSurface& surface, const TriangleTopology& topology) {
  constexpr int kRounds = 8;
  constexpr double kWidth = 25 * kDegree;  // normals that differ by more hardly count
  Eigen::Matrix3Xd normals(3, topology.triangles());
  Eigen::VectorXd areas(normals.cols());
  for (Eigen::Index t = 0; t < normals.cols(); ++t) {
    const auto corner = surface.triangles.col(t);
    const Eigen::Vector3d a = surface.vertices.col(corner[0]);
    const Eigen::Vector3d cross =
        (surface.vertices.col(corner[1]) - a).cross(surface.vertices.col(corner[2]) - a);
    areas[t] = cross.norm();
    normals.col(t) = cross.stableNormalized();
  }
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix3Xd next = normals * areas.asDiagonal();
    for (int h = 0; h < topology.half_edges(); ++h) {
      const int t = h / 3, beside = topology.Twin(h) / 3;
      const double square = (normals.col(t) - normals.col(beside)).squaredNorm();
      next.col(t) += areas[beside] * std::exp(-square / (kWidth * kWidth)) * normals.col(beside);
    }
    for (Eigen::Index t = 0; t < normals.cols(); ++t)
      normals.col(t) = next.col(t).stableNormalized();
  }
  return normals;
}

class CreaseFinder {
 public:
  explicit CreaseFinder(const TriangleSurface& surface)
      : surface_(surface), topology_(surface), angle_(std::size_t(topology_.half_edges())) {
    const Eigen::Matrix3Xd normals = MeanNormals(surface, topology_);
    for (int h = 0; h < topology_.half_edges(); ++h) {
      const Eigen::Vector3d one = normals.col(h / 3), two = normals.col(topology_.Twin(h) / 3);
      angle_[std::size_t(h)] = std::atan2(one.cross(two).norm(), one.dot(two));
    }
  }

  SurfaceCreases Find(double shortest) {
    constexpr double kWeak = 15 * kDegree;
    sharp_.assign(angle_.size(), 0);
    for (int h = 0; h < topology_.half_edges(); ++h) {
      sharp_[std::size_t(h)] = angle_[std::size_t(h)] > kWeak && StandsOut(h);
    }
    CutSpurs(shortest / 2);
    KeepChains(shortest);
    SurfaceCreases creases;
    for (int h = 0; h < topology_.half_edges(); ++h) {
      if (!sharp_[std::size_t(h)] || topology_.Twin(h) < h) continue;
      creases.edges.push_back({std::min(Origin(h), Target(h)), std::max(Origin(h), Target(h))});
    }
    FindCorners(creases);
    return creases;
  }

 private:
  int Origin(int h) const { return topology_.Origin(h); }
  int Target(int h) const { return topology_.Origin(TriangleTopology::Next(h)); }
  double Length(int h) const {
    return (surface_.vertices.col(Origin(h)) - surface_.vertices.col(Target(h))).norm();
  }

  // Whether normals turn by more over an edge than over those beside it: of the other two edges of
  // each triangle the flatter one counts, for the other may be the crease that goes on.
  bool StandsOut(int h) const {
    constexpr double kMore = 2.5;
    double beside = 0;
    for (const int side : {h, topology_.Twin(h)}) {
      beside = std::max(beside,
                        std::min(angle_[std::size_t(TriangleTopology::Next(side))],
                                 angle_[std::size_t(TriangleTopology::Previous(side))]));
    }
    return angle_[std::size_t(h)] > kMore * beside;
  }

  std::vector<int> SharpFrom(int v) const {
    std::vector<int> found;
    const int first = topology_.Outgoing(v);
    int h = first;
    do {
      if (sharp_[std::size_t(h)]) found.push_back(h);
      h = topology_.Turned(h);
    } while (h != first);
    return found;
  }

  void Drop(int h) { sharp_[std::size_t(h)] = sharp_[std::size_t(topology_.Twin(h))] = 0; }

  // Branches that end soon after they leave another crease.
  void CutSpurs(double shortest) {
    for (int v = 0; v < topology_.vertices(); ++v) {
      std::vector<int> ways = SharpFrom(v);
      if (ways.size() != 1) continue;
      std::vector<int> branch;
      double length = 0;
      while (ways.size() == 1 && length < shortest) {
        const int h = ways.front();
        branch.push_back(h);
        length += Length(h);
        ways = SharpFrom(Target(h));
        std::erase(ways, topology_.Twin(h));
      }
      if (length < shortest) std::for_each(branch.begin(), branch.end(), [&](int h) { Drop(h); });
    }
  }

  // Connected ones that are long enough and somewhere sharp enough.
  void KeepChains(double shortest) {
    constexpr double kStrong = 35 * kDegree;
    std::vector<char> seen(std::size_t(topology_.vertices()), 0);
    for (int start = 0; start < topology_.vertices(); ++start) {
      if (seen[std::size_t(start)]) continue;
      std::vector<int> open = {start}, edges;
      seen[std::size_t(start)] = 1;
      double length = 0, greatest = 0;
      while (!open.empty()) {
        const int v = open.back();
        open.pop_back();
        for (const int h : SharpFrom(v)) {
          edges.push_back(h);
          length += Length(h) / 2;
          greatest = std::max(greatest, angle_[std::size_t(h)]);
          if (seen[std::size_t(Target(h))]) continue;
          seen[std::size_t(Target(h))] = 1;
          open.push_back(Target(h));
        }
      }
      if (length < shortest || greatest < kStrong) {
        std::for_each(edges.begin(), edges.end(), [&](int h) { Drop(h); });
      }
    }
  }

  void FindCorners(SurfaceCreases& creases) const {
    constexpr double kTurn = 45 * kDegree;
    creases.corner.assign(std::size_t(topology_.vertices()), 0);
    for (int v = 0; v < topology_.vertices(); ++v) {
      const std::vector<int> ways = SharpFrom(v);
      if (ways.size() == 2) {
        const Eigen::Vector3d at = surface_.vertices.col(v);
        const Eigen::Vector3d one = surface_.vertices.col(Target(ways[0])) - at;
        const Eigen::Vector3d two = at - surface_.vertices.col(Target(ways[1]));
        creases.corner[std::size_t(v)] = std::atan2(one.cross(two).norm(), one.dot(two)) > kTurn;
      } else {
        creases.corner[std::size_t(v)] = !ways.empty();
      }
    }
  }

  const TriangleSurface& surface_;
  TriangleTopology topology_;
  std::vector<double> angle_;  // by half-edge, radians
  std::vector<char> sharp_;
};

}  // namespace

SurfaceCreases CreasesOf(const TriangleSurface& surface, double shortest) {
  return CreaseFinder(surface).Find(shortest);
}

Eigen::Vector3d NearestOnCreases(const TriangleSurface& surface,
                                 const SurfaceCreases& creases,
                                 const Eigen::Vector3d& p) {
  Eigen::Vector3d best = p;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [a, b] : creases.edges) {
    const Eigen::Vector3d from = surface.vertices.col(a), way = surface.vertices.col(b) - from;
    const double share = std::clamp(way.dot(p - from) / way.squaredNorm(), 0.0, 1.0);
    const Eigen::Vector3d place = from + share * way;
    if ((place - p).squaredNorm() >= least) continue;
    least = (place - p).squaredNorm();
    best = place;
  }
  return best;
}

}  // namespace batten::internal
