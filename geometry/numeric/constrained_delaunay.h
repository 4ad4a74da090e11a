// SPDX-License-Identifier: MIT
// A constrained Delaunay triangulation of points with whole coordinates. Internal to geometry.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace batten::internal {

struct LatticePoint {
  std::int64_t x, y;

  bool operator==(const LatticePoint&) const = default;
};

// Twice the area of a, b, c: positive where they turn counter-clockwise. Exact up to 2^30.
std::int64_t Turn(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c);

// Triangles over a square, with points and edges added one by one. Coordinates are whole numbers
// from 0 to kReach, so that all decisions are exact: triangles never overlap, and
// every edge is Delaunay, or fixed, or kept by a fixed one. The first four vertices are the corners
// of the square, out of reach of all others.
// A fixed edge is never flipped. Its `odd` mark tells how often, modulo two, segments of loops run
// along it; loops being closed, the places with an odd number of loops around them are inside.
// [Lawson 1977; Sloan 1993, "A fast algorithm for generating constrained Delaunay triangulations"]
class ConstrainedDelaunay {
 public:
  static constexpr std::int64_t kReach = std::int64_t{1} << 29;

  struct Triangle {
    std::array<int, 3> vertices;    // counter-clockwise
    std::array<int, 3> neighbours;  // [e] lies across the edge opposite vertices[e]; −1: none
    std::uint8_t fixed = 0;         // bit e: that edge is fixed
    std::uint8_t odd = 0;           // bit e: that edge bounds the inside
    bool inside = false;
  };
  // An edge of a triangle: the one opposite its vertex `edge`.
  struct Place {
    int triangle, edge;
  };

  ConstrainedDelaunay();

  const std::vector<LatticePoint>& points() const { return points_; }
  const std::vector<Triangle>& triangles() const { return triangles_; }

  // The vertex at the point, a new one unless there is one. New vertices on edges inherit marks.
  int Insert(const LatticePoint& point);

  // Makes the segment a union of fixed edges, and turns their odd marks if it belongs to a loop.
  // Where it meets fixed edges a vertex is added at the nearest whole point, and both bend there.
  void FixSegment(int from, int to, bool of_loop);

  // Sets Triangle::inside by the odd marks.
  void FindInside();

  // Puts a vertex at `point` into the edge, whose ends it must lie between but for rounding, and
  // returns it; none where a triangle would vanish.
  std::optional<int> SplitEdge(Place place, const LatticePoint& point);

  // The triangle that holds the point, its border included.
  int Find(const LatticePoint& point);

  // The edge in one of its two triangles; none where the two are not joined.
  std::optional<Place> EdgeBetween(int from, int to) const;

  // The vertex that has come to lie between two that were the ends of a fixed segment or of a part
  // of one; −1: none, they are joined.
  int CutOf(int from, int to) const;

  // Triangles made or changed since the last call, some more than once.
  std::vector<int> TakeChanged() { return std::exchange(changed_, {}); }

 private:
  struct Segment {
    int from, to;
    bool odd;
  };

  void Set(int triangle, const Triangle& value);
  void Relink(int neighbour, int from, int to);
  void Flip(Place place);
  bool Convex(Place place) const;
  bool ShouldFlip(Place place) const;
  void LegalizeAround(int vertex, std::vector<int> triangles);
  void LegalizeEdges(std::vector<std::pair<int, int>> edges);
  int SplitTriangle(int triangle, const LatticePoint& point);
  void FixStep(const Segment& segment);
  void Shorten(const Segment& segment, int vertex);
  void BendAt(const Segment& segment, Place place);
  void Mark(int from, int to, bool odd);
  void NoteCut(int from, int to, int vertex);
  std::vector<Place> Around(int vertex) const;

  std::vector<LatticePoint> points_;
  std::vector<Triangle> triangles_;
  std::vector<int> at_;  // a triangle of every vertex
  std::vector<int> changed_;
  std::map<std::pair<int, int>, int> cuts_;  // of fixed segments, the lesser end first
  std::vector<Segment> waiting_;
  int last_ = 0;  // where searches begin
  unsigned turns_ = 1;
};

}  // namespace batten::internal
