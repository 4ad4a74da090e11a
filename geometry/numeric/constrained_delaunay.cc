// SPDX-License-Identifier: MIT
#include "geometry/numeric/constrained_delaunay.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <stdexcept>

namespace batten::internal {
namespace {

constexpr int Next(int e) { return e == 2 ? 0 : e + 1; }
constexpr int Last(int e) { return e == 0 ? 2 : e - 1; }

// Whether d lies inside the circle through a, b, c, which turn counter-clockwise.
bool InCircle(const LatticePoint& a,
              const LatticePoint& b,
              const LatticePoint& c,
              const LatticePoint& d) {
  __extension__ using Wide = __int128;  // terms reach 2^124
  const std::int64_t ax = a.x - d.x, ay = a.y - d.y, bx = b.x - d.x, by = b.y - d.y;
  const std::int64_t cx = c.x - d.x, cy = c.y - d.y;
  const Wide determinant = Wide(ax * ax + ay * ay) * (bx * cy - by * cx) +
                           Wide(bx * bx + by * by) * (cx * ay - cy * ax) +
                           Wide(cx * cx + cy * cy) * (ax * by - ay * bx);
  return determinant > 0;
}

int IndexOf(const ConstrainedDelaunay::Triangle& triangle, int vertex) {
  return triangle.vertices[0] == vertex ? 0 : triangle.vertices[1] == vertex ? 1 : 2;
}

// The marks of edge `from`, as marks of edge `to`.
std::uint8_t Bit(std::uint8_t marks, int from, int to) {
  return static_cast<std::uint8_t>(((marks >> from) & 1) << to);
}

}  // namespace

std::int64_t Turn(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

ConstrainedDelaunay::ConstrainedDelaunay() {
  constexpr std::int64_t kLow = -kReach / 2, kHigh = kReach + kReach / 2;
  points_ = {{kLow, kLow}, {kHigh, kLow}, {kHigh, kHigh}, {kLow, kHigh}};
  triangles_.resize(2);
  triangles_[0].vertices = {0, 1, 2};
  triangles_[0].neighbours = {-1, 1, -1};
  triangles_[1].vertices = {0, 2, 3};
  triangles_[1].neighbours = {-1, -1, 0};
  at_ = {0, 0, 0, 1};
}

void ConstrainedDelaunay::Set(int triangle, const Triangle& value) {
  if (triangle == static_cast<int>(triangles_.size())) triangles_.emplace_back();
  triangles_[triangle] = value;
  for (const int vertex : value.vertices) at_[vertex] = triangle;
  changed_.push_back(triangle);
}

void ConstrainedDelaunay::Relink(int neighbour, int from, int to) {
  if (neighbour < 0) return;
  for (int& link : triangles_[neighbour].neighbours) {
    if (link == from) {
      link = to;
      return;
    }
  }
}

// The diagonal of the two triangles at the edge changes; both have the old corner first.
void ConstrainedDelaunay::Flip(Place place) {
  const int t = place.triangle, e = place.edge;
  const Triangle near = triangles_[t];
  const int o = near.neighbours[e];
  const Triangle far = triangles_[o];
  const int p = near.vertices[e], a = near.vertices[Next(e)], b = near.vertices[Last(e)];
  const int f = 3 - IndexOf(far, a) - IndexOf(far, b);
  const int q = far.vertices[f];
  Triangle first, second;
  first.vertices = {p, a, q};
  first.neighbours = {far.neighbours[Next(f)], o, near.neighbours[Last(e)]};
  first.fixed = Bit(far.fixed, Next(f), 0) | Bit(near.fixed, Last(e), 2);
  first.odd = Bit(far.odd, Next(f), 0) | Bit(near.odd, Last(e), 2);
  second.vertices = {p, q, b};
  second.neighbours = {far.neighbours[Last(f)], near.neighbours[Next(e)], t};
  second.fixed = Bit(far.fixed, Last(f), 0) | Bit(near.fixed, Next(e), 1);
  second.odd = Bit(far.odd, Last(f), 0) | Bit(near.odd, Next(e), 1);
  first.inside = second.inside = near.inside;
  Relink(first.neighbours[0], o, t);
  Relink(second.neighbours[1], t, o);
  Set(t, first);
  Set(o, second);
}

bool ConstrainedDelaunay::Convex(Place place) const {
  const Triangle& near = triangles_[place.triangle];
  const Triangle& far = triangles_[near.neighbours[place.edge]];
  const int p = near.vertices[place.edge];
  const int a = near.vertices[Next(place.edge)], b = near.vertices[Last(place.edge)];
  const int q = far.vertices[3 - IndexOf(far, a) - IndexOf(far, b)];
  return Turn(points_[p], points_[a], points_[q]) > 0 &&
         Turn(points_[p], points_[q], points_[b]) > 0;
}

bool ConstrainedDelaunay::ShouldFlip(Place place) const {
  const Triangle& near = triangles_[place.triangle];
  if (near.neighbours[place.edge] < 0 || (near.fixed >> place.edge & 1)) return false;
  const Triangle& far = triangles_[near.neighbours[place.edge]];
  const int a = near.vertices[Next(place.edge)], b = near.vertices[Last(place.edge)];
  const int q = far.vertices[3 - IndexOf(far, a) - IndexOf(far, b)];
  return InCircle(points_[near.vertices[0]],
                  points_[near.vertices[1]],
                  points_[near.vertices[2]],
                  points_[q]) &&
         Convex(place);
}

// Flips what has to be, beginning with the edges opposite the vertex in these triangles.
void ConstrainedDelaunay::LegalizeAround(int vertex, std::vector<int> triangles) {
  while (!triangles.empty()) {
    const int t = triangles.back();
    const Place place{t, IndexOf(triangles_[t], vertex)};
    if (!ShouldFlip(place)) {
      triangles.pop_back();
      continue;
    }
    const int other = triangles_[t].neighbours[place.edge];
    Flip(place);
    triangles.push_back(other);
  }
}

void ConstrainedDelaunay::LegalizeEdges(std::vector<std::pair<int, int>> edges) {
  while (!edges.empty()) {
    const auto [from, to] = edges.back();
    edges.pop_back();
    const std::optional<Place> place = EdgeBetween(from, to);
    if (!place || !ShouldFlip(*place)) continue;
    const int other = triangles_[place->triangle].neighbours[place->edge];
    Flip(*place);
    const auto& first = triangles_[place->triangle].vertices;
    const auto& second = triangles_[other].vertices;
    edges.insert(edges.end(),
                 {{first[0], first[1]},
                  {first[1], first[2]},
                  {second[1], second[2]},
                  {second[2], second[0]}});
  }
}

int ConstrainedDelaunay::SplitTriangle(int triangle, const LatticePoint& point) {
  const int vertex = static_cast<int>(points_.size());
  points_.push_back(point);
  at_.push_back(triangle);
  const Triangle whole = triangles_[triangle];
  const int next = static_cast<int>(triangles_.size());
  const std::array<int, 3> ids{triangle, next, next + 1};
  for (int e = 0; e < 3; ++e) {
    Triangle part;
    part.vertices = {vertex, whole.vertices[Next(e)], whole.vertices[Last(e)]};
    part.neighbours = {whole.neighbours[e], ids[Next(e)], ids[Last(e)]};
    part.fixed = Bit(whole.fixed, e, 0);
    part.odd = Bit(whole.odd, e, 0);
    part.inside = whole.inside;
    Set(ids[e], part);
    Relink(whole.neighbours[e], triangle, ids[e]);
  }
  LegalizeAround(vertex, {ids.begin(), ids.end()});
  return vertex;
}

std::optional<int> ConstrainedDelaunay::SplitEdge(Place place, const LatticePoint& point) {
  const int t = place.triangle, e = place.edge, o = triangles_[t].neighbours[e];
  if (o < 0) return std::nullopt;
  const Triangle near = triangles_[t], far = triangles_[o];
  const int p = near.vertices[e], a = near.vertices[Next(e)], b = near.vertices[Last(e)];
  const int f = 3 - IndexOf(far, a) - IndexOf(far, b), q = far.vertices[f];
  for (const auto& [i, j] : {std::pair{p, a}, {b, p}, {q, b}, {a, q}}) {
    if (Turn(points_[i], points_[j], point) <= 0) return std::nullopt;
  }
  const int vertex = static_cast<int>(points_.size());
  points_.push_back(point);
  at_.push_back(t);
  const int t2 = static_cast<int>(triangles_.size()), o2 = t2 + 1;
  const std::uint8_t fixed = near.fixed >> e & 1, odd = near.odd >> e & 1;
  if (fixed) NoteCut(a, b, vertex);
  // A part has the vertex first, then the edge of the whole that it keeps.
  const auto part = [vertex](const Triangle& whole, int kept, int second, int third) {
    Triangle result;
    result.vertices = {vertex, whole.vertices[Next(kept)], whole.vertices[Last(kept)]};
    result.neighbours = {whole.neighbours[kept], second, third};
    result.fixed = Bit(whole.fixed, kept, 0);
    result.odd = Bit(whole.odd, kept, 0);
    result.inside = whole.inside;
    return result;
  };
  Triangle pa = part(near, Last(e), o2, t2), bp = part(near, Next(e), t, o);
  Triangle qb = part(far, Last(f), t2, o2), aq = part(far, Next(f), o, t);
  for (Triangle* half : {&pa, &qb}) {
    half->fixed |= fixed << 1;
    half->odd |= odd << 1;
  }
  for (Triangle* half : {&bp, &aq}) {
    half->fixed |= fixed << 2;
    half->odd |= odd << 2;
  }
  Set(t, pa);
  Set(o, qb);
  Set(t2, bp);
  Set(o2, aq);
  Relink(bp.neighbours[0], t, t2);
  Relink(aq.neighbours[0], o, o2);
  LegalizeAround(vertex, {t, o, t2, o2});
  return vertex;
}

int ConstrainedDelaunay::Find(const LatticePoint& point) {
  for (int t = last_;;) {
    const Triangle& here = triangles_[t];
    turns_ = turns_ * 1664525u + 1013904223u;  // no cycles: the first side asked varies
    const int start = static_cast<int>(turns_ >> 16) % 3;
    int next = -1;
    for (int k = 0; k < 3 && next < 0; ++k) {
      const int e = (start + k) % 3;
      const auto& v = here.vertices;
      if (Turn(points_[v[Next(e)]], points_[v[Last(e)]], point) < 0) next = here.neighbours[e];
    }
    if (next < 0) return last_ = t;
    t = next;
  }
}

int ConstrainedDelaunay::Insert(const LatticePoint& point) {
  const int t = Find(point);
  const auto& v = triangles_[t].vertices;
  for (const int vertex : v) {
    if (points_[vertex] == point) return vertex;
  }
  for (int e = 0; e < 3; ++e) {
    if (Turn(points_[v[Next(e)]], points_[v[Last(e)]], point) == 0)
      return *SplitEdge({t, e}, point);
  }
  return SplitTriangle(t, point);
}

// The triangles around a vertex, with its place in them.
std::vector<ConstrainedDelaunay::Place> ConstrainedDelaunay::Around(int vertex) const {
  std::vector<Place> places;
  const int first = at_[vertex];
  int t = first;
  do {
    const int e = IndexOf(triangles_[t], vertex);
    places.push_back({t, e});
    t = triangles_[t].neighbours[Next(e)];
  } while (t >= 0 && t != first);
  if (t == first) return places;
  // A corner of the square: the other way round too.
  t = triangles_[first].neighbours[Last(IndexOf(triangles_[first], vertex))];
  while (t >= 0) {
    const int e = IndexOf(triangles_[t], vertex);
    places.push_back({t, e});
    t = triangles_[t].neighbours[Last(e)];
  }
  return places;
}

std::optional<ConstrainedDelaunay::Place> ConstrainedDelaunay::EdgeBetween(int from, int to) const {
  for (const Place& place : Around(from)) {
    const auto& v = triangles_[place.triangle].vertices;
    if (v[Next(place.edge)] == to) return Place{place.triangle, Last(place.edge)};
    if (v[Last(place.edge)] == to) return Place{place.triangle, Next(place.edge)};
  }
  return std::nullopt;
}

void ConstrainedDelaunay::Mark(int from, int to, bool odd) {
  const Place place = *EdgeBetween(from, to);
  const int other = triangles_[place.triangle].neighbours[place.edge];
  for (const int t : {place.triangle, other}) {
    if (t < 0) continue;
    Triangle& triangle = triangles_[t];
    const int e = 3 - IndexOf(triangle, from) - IndexOf(triangle, to);
    triangle.fixed |= static_cast<std::uint8_t>(1 << e);
    if (odd) triangle.odd ^= static_cast<std::uint8_t>(1 << e);
  }
}

void ConstrainedDelaunay::FixSegment(int from, int to, bool of_loop) {
  constexpr int kMostSteps = 100000;  // far more vertices than a segment can meet in good loops
  waiting_.push_back({from, to, of_loop});
  for (int step = 0; !waiting_.empty(); ++step) {
    if (step > kMostSteps) {
      throw std::invalid_argument(
          "Tessellate: surface: trim loops run along one another too often");
    }
    const Segment segment = waiting_.back();
    waiting_.pop_back();
    if (segment.from != segment.to) FixStep(segment);
  }
}

// Fixes the segment up to the first vertex on it, or bends it at the first fixed edge across it.
void ConstrainedDelaunay::FixStep(const Segment& segment) {
  const LatticePoint from = points_[segment.from], to = points_[segment.to];
  const auto side = [&](int vertex) { return Turn(from, to, points_[vertex]); };
  std::optional<Place> crossed;
  for (const Place& place : Around(segment.from)) {
    const auto& v = triangles_[place.triangle].vertices;
    for (const int vertex : {v[Next(place.edge)], v[Last(place.edge)]}) {
      const LatticePoint& point = points_[vertex];
      const bool ahead =
          (to.x - from.x) * (point.x - from.x) + (to.y - from.y) * (point.y - from.y) > 0;
      if (side(vertex) != 0 || !ahead) continue;
      Mark(segment.from, vertex, segment.odd);
      Shorten(segment, vertex);
      return;
    }
    if (side(v[Next(place.edge)]) < 0 && side(v[Last(place.edge)]) > 0) crossed = place;
  }
  std::deque<std::pair<int, int>> edges;
  int target = -1;
  for (Place place = crossed.value(); target < 0;) {
    const Triangle& near = triangles_[place.triangle];
    if (near.fixed >> place.edge & 1) return BendAt(segment, place);
    const int right = near.vertices[Next(place.edge)], left = near.vertices[Last(place.edge)];
    edges.emplace_back(right, left);
    const int o = near.neighbours[place.edge];
    const Triangle& far = triangles_[o];
    const int apex = far.vertices[3 - IndexOf(far, right) - IndexOf(far, left)];
    const std::int64_t turn = side(apex);
    if (turn == 0) target = apex;
    place = {o, IndexOf(far, turn > 0 ? left : right)};
  }
  std::vector<std::pair<int, int>> made;
  while (!edges.empty()) {
    const auto edge = edges.front();
    edges.pop_front();
    const Place place = *EdgeBetween(edge.first, edge.second);
    if (!Convex(place)) {
      edges.push_back(edge);
      continue;
    }
    Flip(place);
    const auto& v = triangles_[place.triangle].vertices;  // the new edge joins [0] and [2]
    const bool ends =
        v[0] == segment.from || v[0] == target || v[2] == segment.from || v[2] == target;
    const bool across = !ends && (side(v[0]) > 0) != (side(v[2]) > 0);
    if (across) {
      edges.emplace_back(v[0], v[2]);
    } else {
      made.emplace_back(v[0], v[2]);
    }
  }
  Mark(segment.from, target, segment.odd);
  LegalizeEdges(std::move(made));
  Shorten(segment, target);
}

// What is left of the segment beyond a vertex on it.
void ConstrainedDelaunay::Shorten(const Segment& segment, int vertex) {
  if (vertex == segment.to) return;
  NoteCut(segment.from, segment.to, vertex);
  waiting_.push_back({vertex, segment.to, segment.odd});
}

// The segment meets the fixed edge between two vertices: both go through a vertex there.
void ConstrainedDelaunay::BendAt(const Segment& segment, Place place) {
  const Triangle near = triangles_[place.triangle];
  const int a = near.vertices[Next(place.edge)], b = near.vertices[Last(place.edge)];
  const LatticePoint from = points_[segment.from], to = points_[segment.to];
  const auto right = static_cast<long double>(Turn(from, to, points_[a]));
  const auto left = static_cast<long double>(Turn(from, to, points_[b]));
  const long double share = right / (right - left);
  const LatticePoint meeting{
      points_[a].x + std::llround(share * static_cast<long double>(points_[b].x - points_[a].x)),
      points_[a].y + std::llround(share * static_cast<long double>(points_[b].y - points_[a].y))};
  const bool odd = near.odd >> place.edge & 1;
  for (const int t : {place.triangle, near.neighbours[place.edge]}) {
    Triangle& triangle = triangles_[t];
    const int e = 3 - IndexOf(triangle, a) - IndexOf(triangle, b);
    triangle.fixed &= static_cast<std::uint8_t>(~(1 << e));
    triangle.odd &= static_cast<std::uint8_t>(~(1 << e));
  }
  const int vertex = Insert(meeting);
  NoteCut(a, b, vertex);
  NoteCut(segment.from, segment.to, vertex);
  for (const Segment& part : {Segment{vertex, segment.to, segment.odd},
                              Segment{segment.from, vertex, segment.odd},
                              Segment{vertex, b, odd},
                              Segment{a, vertex, odd}}) {
    waiting_.push_back(part);
  }
}

void ConstrainedDelaunay::NoteCut(int from, int to, int vertex) {
  if (vertex != from && vertex != to) cuts_.emplace(std::minmax(from, to), vertex);
}

int ConstrainedDelaunay::CutOf(int from, int to) const {
  const auto found = cuts_.find(std::minmax(from, to));
  return found == cuts_.end() ? -1 : found->second;
}

void ConstrainedDelaunay::FindInside() {
  std::vector<char> seen(triangles_.size(), 0);
  std::vector<int> open{at_[0]};
  seen[open[0]] = 1;
  triangles_[open[0]].inside = false;
  while (!open.empty()) {
    const Triangle here = triangles_[open.back()];
    open.pop_back();
    for (int e = 0; e < 3; ++e) {
      const int next = here.neighbours[e];
      if (next < 0 || seen[next]) continue;
      seen[next] = 1;
      triangles_[next].inside = here.inside != bool(here.odd >> e & 1);
      open.push_back(next);
    }
  }
}

}  // namespace batten::internal
