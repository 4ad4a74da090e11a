// SPDX-License-Identifier: MIT
#include "fitting/solid/surface_creases.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <utility>

#include "fitting/solid/triangle_topology.h"

namespace batten::internal {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kTurn = 45 * kDegree;    // of a curve, at a corner
constexpr double kStrong = 35 * kDegree;  // between normals, somewhere in each connected part

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

constexpr std::size_t kEach = 6;  // edges of a crease for a corner, or noise makes them

// How much normals jump over edges, beyond what they bend beside them.
class NormalJumps {
 public:
  // `walls`, by half-edge: over which sides do not go on.
  NormalJumps(const TriangleSurface& surface,
              const TriangleTopology& topology,
              const std::vector<char>& walls)
      : surface_(surface),
        topology_(topology),
        walls_(walls),
        seen_(std::size_t(topology.triangles()), 0) {}

  // The angle between the normals of both sides at an edge, from those near it and farther away.
  double Across(int h) {
    const std::array<Eigen::Vector3d, 2> normal = {NormalAt(h), NormalAt(topology_.Twin(h))};
    return std::atan2(normal[0].cross(normal[1]).norm(), normal[0].dot(normal[1]));
  }

 private:
  Eigen::Vector3d InwardOf(int h) const {
    const Eigen::Vector3d a = surface_.vertices.col(topology_.Origin(h));
    const Eigen::Vector3d along =
        (surface_.vertices.col(topology_.Origin(TriangleTopology::Next(h))) - a).stableNormalized();
    const Eigen::Vector3d way =
        surface_.vertices.col(topology_.Origin(TriangleTopology::Previous(h))) - a;
    return (way - way.dot(along) * along).stableNormalized();
  }

  // The line through mean normals over triangles on the side of a half-edge, and of walls, where
  // it meets that.
  Eigen::Vector3d NormalAt(int h) {
    constexpr double kFar = 4;  // lengths of the edge
    const Eigen::Vector3d a = surface_.vertices.col(topology_.Origin(h)),
                          b = surface_.vertices.col(topology_.Origin(TriangleTopology::Next(h)));
    const Eigen::Vector3d middle = (a + b) / 2;
    const Eigen::Vector3d inward = InwardOf(h), apart = inward - InwardOf(topology_.Twin(h));
    double weight = 0, first = 0, second = 0;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero(), moment = sum;
    std::vector<int> open = {h / 3}, touched = open;
    seen_[std::size_t(h / 3)] = 1;
    while (!open.empty()) {
      const int t = open.back();
      open.pop_back();
      const auto corner = surface_.triangles.col(t);
      const Eigen::Vector3d p = surface_.vertices.col(corner[0]);
      const Eigen::Vector3d q = surface_.vertices.col(corner[1]);
      const Eigen::Vector3d r = surface_.vertices.col(corner[2]);
      const Eigen::Vector3d twice = (q - p).cross(r - p);
      const double depth = ((p + q + r) / 3 - middle).dot(inward);
      weight += twice.norm();
      first += twice.norm() * depth;
      second += twice.norm() * depth * depth;
      sum += twice;
      moment += depth * twice;
      for (int g = 3 * t; g < 3 * t + 3; ++g) {
        const int beside = topology_.Twin(g) / 3;
        if (walls_[std::size_t(g)] || seen_[std::size_t(beside)]) continue;
        const auto its = surface_.triangles.col(beside);
        const Eigen::Vector3d centre =
            (surface_.vertices.col(its[0]) + surface_.vertices.col(its[1]) +
             surface_.vertices.col(its[2])) /
            3;
        if ((centre - middle).norm() > kFar * (b - a).norm() || (centre - middle).dot(apart) < 0) {
          continue;
        }
        seen_[std::size_t(beside)] = 1;
        touched.push_back(beside);
        open.push_back(beside);
      }
    }
    for (const int t : touched) seen_[std::size_t(t)] = 0;
    const double spread = weight * second - first * first;
    constexpr double kSpread = 1e-6;
    if (!(spread > kSpread * weight * second)) return sum.stableNormalized();
    return (second * sum - first * moment).stableNormalized();
  }

  const TriangleSurface& surface_;
  const TriangleTopology& topology_;
  const std::vector<char>& walls_;
  std::vector<char> seen_;  // triangles
};

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
    // Means make steps of bends; what bends is no jump.
    std::vector<char> walls(angle_.size());
    for (std::size_t h = 0; h < walls.size(); ++h) walls[h] = sharp_[h] && angle_[h] > kStrong;
    NormalJumps jumps(surface_, topology_, walls);
    std::vector<double> jump(angle_.size(), 0.0);
    for (int h = 0; h < topology_.half_edges(); ++h) {
      if (sharp_[std::size_t(h)] && topology_.Twin(h) > h) {
        jump[std::size_t(h)] = jump[std::size_t(topology_.Twin(h))] = jumps.Across(h);
      }
    }
    turn_ = std::exchange(angle_, std::move(jump));
    for (std::size_t h = 0; h < angle_.size(); ++h) sharp_[h] = sharp_[h] && angle_[h] > kWeak;
    DropPieces(shortest);
    DropParts(shortest);
    Prolong();
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

  // A chain of edges between vertices at which not two meet.
  struct Piece {
    std::vector<int> edges;
    double length = 0;
    std::size_t turns = 0;  // by more than a smooth curve does from one edge to the next
    double middle = 0;      // angle over its edges, the median
    bool ends = false;      // in no other
  };

  Piece PieceFrom(int first) const {
    Piece piece;
    std::vector<double> angles;
    for (int h = first;;) {
      piece.edges.push_back(h);
      piece.length += Length(h);
      angles.push_back(angle_[std::size_t(h)]);
      const std::vector<int> ways = SharpFrom(Target(h));
      piece.ends = piece.ends || ways.size() == 1;
      if (ways.size() != 2) break;
      const int next = ways[0] == topology_.Twin(h) ? ways[1] : ways[0];
      if (next == first) break;
      piece.turns += TurnBetween(h, next) > kTurn;
      h = next;
    }
    piece.ends = piece.ends || SharpFrom(Origin(first)).size() == 1;
    const auto middle = angles.begin() + std::ptrdiff_t(angles.size() / 2);
    std::nth_element(angles.begin(), middle, angles.end());
    piece.middle = *middle;
    return piece;
  }

  double TurnBetween(int h, int next) const {
    const Eigen::Vector3d one = surface_.vertices.col(Target(h)) - surface_.vertices.col(Origin(h));
    const Eigen::Vector3d two =
        surface_.vertices.col(Target(next)) - surface_.vertices.col(Origin(next));
    return std::atan2(one.cross(two).norm(), one.dot(two));
  }

  // Those that turn hither and thither, hardly jump, or end soon after they leave another; over and
  // over, for what they ended at may then go on.
  void DropPieces(double shortest) {
    constexpr double kLeast = 25 * kDegree;
    for (bool more = true; more;) {
      more = false;
      for (int h = 0; h < topology_.half_edges(); ++h) {
        if (!sharp_[std::size_t(h)] || SharpFrom(Origin(h)).size() == 2) continue;
        const Piece piece = PieceFrom(h);
        const bool ragged = piece.turns > 1 && piece.turns * kEach > piece.edges.size();
        if (!ragged && piece.middle >= kLeast && !(piece.ends && piece.length < shortest)) continue;
        std::for_each(piece.edges.begin(), piece.edges.end(), [&](int g) { Drop(g); });
        more = true;
      }
    }
  }

  // Creases go on from their ends over edges that still turn, straight on, until they meet another.
  void Prolong() {
    constexpr double kLeast = 8 * kDegree;
    constexpr double kStraight = 40 * kDegree;
    std::vector<int> ends;
    for (int v = 0; v < topology_.vertices(); ++v) {
      if (SharpFrom(v).size() == 1) ends.push_back(v);
    }
    for (int v : ends) {
      for (std::vector<int> ways = SharpFrom(v); ways.size() == 1; ways = SharpFrom(v)) {
        const int before = topology_.Twin(ways.front());
        int best = -1;
        int h = topology_.Turned(ways.front());
        for (; h != ways.front(); h = topology_.Turned(h)) {
          if (turn_[std::size_t(h)] < kLeast || TurnBetween(before, h) > kStraight) continue;
          if (best < 0 || turn_[std::size_t(h)] > turn_[std::size_t(best)]) best = h;
        }
        if (best < 0) break;
        sharp_[std::size_t(best)] = sharp_[std::size_t(topology_.Twin(best))] = 1;
        angle_[std::size_t(best)] = angle_[std::size_t(topology_.Twin(best))] =
            turn_[std::size_t(best)];
        v = Target(best);
      }
    }
  }

  // Connected parts that are not long enough, nowhere sharp enough, or part nothing from the rest.
  void DropParts(double shortest) {
    std::vector<char> seen(std::size_t(topology_.vertices()), 0);
    for (int start = 0; start < topology_.vertices(); ++start) {
      if (seen[std::size_t(start)]) continue;
      std::vector<int> open = {start}, edges;
      seen[std::size_t(start)] = 1;
      double length = 0, greatest = 0;
      std::size_t vertices = 0, turns = 0;
      while (!open.empty()) {
        const int v = open.back();
        open.pop_back();
        ++vertices;
        turns += TurnsAt(v);
        for (const int h : SharpFrom(v)) {
          edges.push_back(h);
          length += Length(h) / 2;
          greatest = std::max(greatest, angle_[std::size_t(h)]);
          if (seen[std::size_t(Target(h))]) continue;
          seen[std::size_t(Target(h))] = 1;
          open.push_back(Target(h));
        }
      }
      constexpr std::size_t kFewest = 12;  // edges, as a box has
      const bool tree = edges.size() / 2 < std::max(vertices, kFewest);
      const bool ragged = turns * kEach > edges.size() / 2;
      if (length < shortest || greatest < kStrong || tree || ragged) {
        std::for_each(edges.begin(), edges.end(), [&](int h) { Drop(h); });
      }
    }
  }

  // Whether two creases meet there at a corner.
  bool TurnsAt(int v) const {
    const std::vector<int> ways = SharpFrom(v);
    return ways.size() == 2 && TurnBetween(topology_.Twin(ways[0]), ways[1]) > kTurn;
  }

  void FindCorners(SurfaceCreases& creases) const {
    creases.corner.assign(std::size_t(topology_.vertices()), 0);
    for (int v = 0; v < topology_.vertices(); ++v) {
      const std::size_t ways = SharpFrom(v).size();
      creases.corner[std::size_t(v)] = ways == 2 ? TurnsAt(v) : ways > 0;
    }
  }

  const TriangleSurface& surface_;
  TriangleTopology topology_;
  std::vector<double> angle_, turn_;  // by half-edge, radians: what jumps, and of mean normals
  std::vector<char> sharp_;           // by half-edge
};

}  // namespace

std::vector<char> CreasesByHalfEdge(const TriangleTopology& topology,
                                    const SurfaceCreases& creases) {
  std::vector<char> marks(std::size_t(topology.half_edges()), 0);
  if (creases.none()) return marks;
  const std::set<std::array<int, 2>> edges(creases.edges.begin(), creases.edges.end());
  for (int h = 0; h < topology.half_edges(); ++h) {
    const int a = topology.Origin(h), b = topology.Origin(TriangleTopology::Next(h));
    marks[std::size_t(h)] = edges.count({std::min(a, b), std::max(a, b)}) > 0;
  }
  return marks;
}

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
