// SPDX-License-Identifier: MIT
#include "fitting/solid/surface_creases.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "fitting/core/rounding.h"
#include "fitting/solid/normal_jumps.h"
#include "fitting/solid/triangle_topology.h"
#include "geometry/numeric/polygon.h"

namespace batten::internal {
namespace {

constexpr double kTurn = 45 * kOneDegree;    // of a curve, at a corner
constexpr double kStrong = 35 * kOneDegree;  // between normals, somewhere in each connected part
constexpr double kWeak = 15 * kOneDegree;    // everywhere but where a crease is prolonged

constexpr std::size_t kEach = 6;  // edges of a crease for a corner, or noise makes them

// Marked edges of a surface, and how they go on. Keeps references.
class MarkedEdges {
 public:
  // `marks`: by half-edge, alike for twins.
  MarkedEdges(const TriangleSurface& surface,
              const TriangleTopology& topology,
              std::vector<char> marks)
      : surface_(surface), topology_(topology), marks_(std::move(marks)) {}

  const TriangleTopology& topology() const { return topology_; }
  bool Has(int h) const { return marks_[std::size_t(h)]; }
  void Mark(int h, bool mark) {
    marks_[std::size_t(h)] = marks_[std::size_t(topology_.Twin(h))] = mark;
  }

  int Origin(int h) const { return topology_.Origin(h); }
  int Target(int h) const { return topology_.Origin(TriangleTopology::Next(h)); }
  double Length(int h) const {
    return (surface_.vertices.col(Origin(h)) - surface_.vertices.col(Target(h))).norm();
  }

  // Marked half-edges that begin at a vertex.
  std::vector<int> From(int v) const {
    std::vector<int> found;
    const int first = topology_.Outgoing(v);
    int h = first;
    do {
      if (Has(h)) found.push_back(h);
      h = topology_.Turned(h);
    } while (h != first);
    return found;
  }

  double TurnBetween(int h, int next) const {
    const Eigen::Vector3d one = surface_.vertices.col(Target(h)) - surface_.vertices.col(Origin(h));
    const Eigen::Vector3d two =
        surface_.vertices.col(Target(next)) - surface_.vertices.col(Origin(next));
    return AngleBetween(one, two);
  }

  // Whether two of them meet there at a corner.
  bool TurnsAt(int v) const {
    const std::vector<int> ways = From(v);
    return ways.size() == 2 && TurnBetween(topology_.Twin(ways[0]), ways[1]) > kTurn;
  }

 private:
  const TriangleSurface& surface_;
  const TriangleTopology& topology_;
  std::vector<char> marks_;
};

// Edges over which normals turn by more than over those beside them: of the other two edges of each
// triangle the flatter one counts, for the other may be the crease that goes on.
std::vector<char> StandingOut(const TriangleTopology& topology, const std::vector<double>& turn) {
  constexpr double kMore = 2.5;
  std::vector<char> marks(turn.size());
  for (int h = 0; h < topology.half_edges(); ++h) {
    double beside = 0;
    for (const int side : {h, topology.Twin(h)}) {
      beside = std::max(beside,
                        std::min(turn[std::size_t(TriangleTopology::Next(side))],
                                 turn[std::size_t(TriangleTopology::Previous(side))]));
    }
    const double own = turn[std::size_t(h)];
    marks[std::size_t(h)] = own > kWeak && own > kMore * beside;
  }
  return marks;
}

// A chain of edges between vertices at which not two meet.
struct Piece {
  std::vector<int> edges;
  double length = 0;
  std::size_t turns = 0;  // by more than a smooth curve does from one edge to the next
  double middle = 0;      // jump over its edges, the median
  bool ends = false;      // in no other
};

Piece PieceFrom(int first, const MarkedEdges& creases, const std::vector<double>& jump) {
  Piece piece;
  std::vector<double> angles;
  for (int h = first;;) {
    piece.edges.push_back(h);
    piece.length += creases.Length(h);
    angles.push_back(jump[std::size_t(h)]);
    const std::vector<int> ways = creases.From(creases.Target(h));
    piece.ends = piece.ends || ways.size() == 1;
    if (ways.size() != 2) break;
    const int next = ways[0] == creases.topology().Twin(h) ? ways[1] : ways[0];
    if (next == first) break;
    piece.turns += creases.TurnBetween(h, next) > kTurn;
    h = next;
  }
  piece.ends = piece.ends || creases.From(creases.Origin(first)).size() == 1;
  const auto middle = angles.begin() + std::ptrdiff_t(angles.size() / 2);
  std::nth_element(angles.begin(), middle, angles.end());
  piece.middle = *middle;
  return piece;
}

// Drops those that turn hither and thither, hardly jump, or end soon after they leave another; over
// and over, for what they ended at may then go on.
void DropPieces(double shortest, const std::vector<double>& jump, MarkedEdges& creases) {
  constexpr double kLeast = 25 * kOneDegree;
  for (bool more = true; more;) {
    more = false;
    for (int h = 0; h < creases.topology().half_edges(); ++h) {
      if (!creases.Has(h) || creases.From(creases.Origin(h)).size() == 2) continue;
      const Piece piece = PieceFrom(h, creases, jump);
      const bool ragged = piece.turns > 1 && piece.turns * kEach > piece.edges.size();
      if (!ragged && piece.middle >= kLeast && !(piece.ends && piece.length < shortest)) continue;
      for (const int g : piece.edges) creases.Mark(g, false);
      more = true;
    }
  }
}

// Drops connected parts that are not long enough, nowhere sharp enough, or part nothing from the
// rest.
void DropParts(double shortest, const std::vector<double>& jump, MarkedEdges& creases) {
  constexpr std::size_t kFewest = 12;  // edges, as a box has
  const int count = creases.topology().vertices();
  std::vector<char> seen(std::size_t(count), 0);
  for (int start = 0; start < count; ++start) {
    if (seen[std::size_t(start)]) continue;
    std::vector<int> open = {start}, edges;
    seen[std::size_t(start)] = 1;
    double length = 0, greatest = 0;
    std::size_t vertices = 0, turns = 0;
    while (!open.empty()) {
      const int v = open.back();
      open.pop_back();
      ++vertices;
      turns += creases.TurnsAt(v);
      for (const int h : creases.From(v)) {
        edges.push_back(h);
        length += creases.Length(h) / 2;
        greatest = std::max(greatest, jump[std::size_t(h)]);
        const int target = creases.Target(h);
        if (seen[std::size_t(target)]) continue;
        seen[std::size_t(target)] = 1;
        open.push_back(target);
      }
    }
    const bool tree = edges.size() / 2 < std::max(vertices, kFewest);
    const bool ragged = turns * kEach > edges.size() / 2;
    if (length < shortest || greatest < kStrong || tree || ragged) {
      for (const int h : edges) creases.Mark(h, false);
    }
  }
}

// Creases go on from their ends over edges that still turn, straight on, until they meet another.
void Prolong(const std::vector<double>& turn, MarkedEdges& creases) {
  constexpr double kLeast = 8 * kOneDegree;
  constexpr double kStraight = 40 * kOneDegree;
  const TriangleTopology& topology = creases.topology();
  std::vector<int> ends;
  for (int v = 0; v < topology.vertices(); ++v) {
    if (creases.From(v).size() == 1) ends.push_back(v);
  }
  for (int v : ends) {
    for (std::vector<int> ways = creases.From(v); ways.size() == 1; ways = creases.From(v)) {
      const int before = topology.Twin(ways.front());
      int best = -1;
      int h = topology.Turned(ways.front());
      for (; h != ways.front(); h = topology.Turned(h)) {
        if (turn[std::size_t(h)] < kLeast || creases.TurnBetween(before, h) > kStraight) continue;
        if (best < 0 || turn[std::size_t(h)] > turn[std::size_t(best)]) best = h;
      }
      if (best < 0) break;
      creases.Mark(best, true);
      v = creases.Target(best);
    }
  }
}

SurfaceCreases CreasesFrom(const MarkedEdges& marked) {
  const TriangleTopology& topology = marked.topology();
  SurfaceCreases creases;
  for (int h = 0; h < topology.half_edges(); ++h) {
    if (!marked.Has(h) || topology.Twin(h) < h) continue;
    const auto [low, high] = std::minmax({marked.Origin(h), marked.Target(h)});
    creases.edges.push_back({low, high});
  }
  for (int v = 0; v < topology.vertices(); ++v) {
    const std::size_t ways = marked.From(v).size();
    creases.corner.push_back(ways == 2 ? marked.TurnsAt(v) : ways > 0);
  }
  return creases;
}

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
  const TriangleTopology topology(surface);
  const std::vector<double> turn = MeanTurns(surface, topology);
  std::vector<char> marks = StandingOut(topology, turn), walls(turn.size());
  // Means make steps of bends; what bends is no jump.
  for (std::size_t h = 0; h < walls.size(); ++h) walls[h] = marks[h] && turn[h] > kStrong;
  const std::vector<double> jump = JumpsAcross(surface, topology, walls, marks);
  for (std::size_t h = 0; h < jump.size(); ++h) marks[h] = marks[h] && jump[h] > kWeak;
  MarkedEdges creases(surface, topology, std::move(marks));
  DropPieces(shortest, jump, creases);
  DropParts(shortest, jump, creases);
  Prolong(turn, creases);
  return CreasesFrom(creases);
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
