// SPDX-License-Identifier: MIT
#include "geometry/mesh/surface_tessellation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/mesh/loop_parameters.h"
#include "geometry/numeric/number_text.h"

namespace batten::internal {

SurfaceTessellation::SurfaceTessellation(const NurbsSurface& surface,
                                         const Eigen::Vector3d& middle,
                                         double tolerance,
                                         const TessellateOptions& options)
    : mesh_(surface, middle),
      region_(mesh_.surface().surface()),
      proof_(mesh_.surface().surface()),
      tolerance_(tolerance),
      options_(options) {
  RefuseTooMany();
}

void SurfaceTessellation::Lay() {
  std::vector<std::vector<int>> chains;
  const std::int64_t w = domain().width(), h = domain().height();
  if (!surface().trimmed()) {
    chains.push_back(
        {mesh_.Insert({0, 0}), mesh_.Insert({w, 0}), mesh_.Insert({w, h}), mesh_.Insert({0, h})});
  }
  for (const NurbsCurve<2>& loop : surface().trims()) {
    std::vector<Eigen::Vector2d> places;
    for (const double at : LoopParameters(loop, evaluator(), tolerance_ / 2)) {
      places.push_back(loop.At(at));
    }
    chains.push_back(LayPlaces(places, 0));
  }
  LayInside(chains);
}

std::vector<std::vector<int>> SurfaceTessellation::LayAlong(
    const std::vector<std::vector<Eigen::Vector2d>>& loops) {
  constexpr std::int64_t kOntoBorder = 64;  // 1e-7 of the domain, to which files keep to its sides
  knots_on_border_ = false;
  std::vector<std::vector<int>> chains;
  for (const auto& places : loops) chains.push_back(LayPlaces(places, kOntoBorder));
  LayInside(chains);
  return chains;
}

std::vector<int> SurfaceTessellation::LayPlaces(const std::vector<Eigen::Vector2d>& places,
                                                std::int64_t onto_border) {
  std::vector<int> chain;
  for (const Eigen::Vector2d& place : places) {
    const LatticePoint point = domain().OntoBorder(domain().Snap(place), onto_border);
    const int vertex = mesh_.Insert(point);
    chain.push_back(vertex);
    if (!domain().OnBorder(point)) mesh_.MoveVertex(vertex, place);
    for (const LatticePoint& mirrored : domain().Mirrored(point)) mesh_.Insert(mirrored);
  }
  return chain;
}

void SurfaceTessellation::LayInside(const std::vector<std::vector<int>>& chains) {
  for (const std::vector<int>& chain : chains) {
    for (std::size_t k = 0; k < chain.size(); ++k) {
      mesh_.delaunay().FixSegment(chain[k], chain[(k + 1) % chain.size()], true);
    }
  }
  mesh_.NoteVertices();
  mesh_.delaunay().FindInside();
  LaySeeds();
  LayCreases();
  mesh_.delaunay().FindInside();
  mesh_.delaunay().TakeChanged();
  const std::size_t count = mesh_.delaunay().triangles().size();
  for (std::size_t t = 0; t < count; ++t) Queue(static_cast<int>(t));
}

void SurfaceTessellation::Refine() {
  EmptyQueue();
  while (SplitDoubledEdges()) EmptyQueue();
}

int SurfaceTessellation::SplitNear(int from, int to, const Eigen::Vector3d& point) {
  const Eigen::Vector3d start = mesh_.point(from), way = mesh_.point(to) - start;
  const Eigen::Vector2d a = mesh_.parameter(from), b = mesh_.parameter(to);
  const double wanted = (point - mesh_.middle() - start).dot(way);
  double lower = 0, upper = 1;
  constexpr int kHalvings = 40;  // finer than the lattice
  for (int k = 0; k < kHalvings; ++k) {
    const double share = (lower + upper) / 2;
    const Eigen::Vector2d place = a + share * (b - a);
    const bool before = (evaluator().At(place[0], place[1]) - start).dot(way) < wanted;
    (before ? lower : upper) = share;
  }
  const LatticePoint p = mesh_.delaunay().points()[from], q = mesh_.delaunay().points()[to];
  const LatticePoint at{p.x + std::llround(lower * static_cast<double>(q.x - p.x)),
                        p.y + std::llround(lower * static_cast<double>(q.y - p.y))};
  constexpr double kHalf = 0.5;
  const int nearer = lower < kHalf ? from : to;
  if (at == p || at == q) return nearer;
  const auto place = mesh_.delaunay().EdgeBetween(from, to);
  return place && SplitHere(*place, at) ? mesh_.size() - 1 : nearer;
}

bool SurfaceTessellation::Halve(int from, int to) {
  const auto place = mesh_.delaunay().EdgeBetween(from, to);
  return place && Split(*place);
}

// An estimate from below the middle of spans, before any work.
void SurfaceTessellation::RefuseTooMany() const {
  constexpr double kSlack = 8;  // of the estimate
  const auto& u = domain().lines_u();
  const auto& v = domain().lines_v();
  double triangles = 0;
  for (std::size_t i = 0; i + 1 < u.size(); ++i) {
    for (std::size_t j = 0; j + 1 < v.size(); ++j) {
      const Eigen::Vector2d lower = domain().ParameterOf({u[i], v[j]});
      const Eigen::Vector2d upper = domain().ParameterOf({u[i + 1], v[j + 1]});
      if (surface().trimmed() && region_.CoverOf({lower[0], upper[0], lower[1], upper[1]}) ==
                                     TrimRegion::Cover::kOutside) {
        continue;
      }
      const Eigen::Vector2d at = (lower + upper) / 2, size = upper - lower;
      const SurfaceJet jet = evaluator().JetAt(at[0], at[1]);
      const Eigen::Vector3d normal = jet.du.cross(jet.dv).normalized();
      const double bend_u = std::abs(normal.dot(jet.duu)) * size[0] * size[0] / 8;
      const double bend_v = std::abs(normal.dot(jet.dvv)) * size[1] * size[1] / 8;
      triangles += 2 * std::max(std::sqrt(bend_u / tolerance_) / kSlack, 1.0) *
                   std::max(std::sqrt(bend_v / tolerance_) / kSlack, 1.0);
    }
  }
  if (triangles > static_cast<double>(options_.max_triangles)) Refuse();
}

void SurfaceTessellation::Refuse() const {
  throw std::invalid_argument("Tessellate: options.chord_tolerance: " + NumberText(tolerance_) +
                              " needs more than the " + std::to_string(options_.max_triangles) +
                              " triangles of options.max_triangles");
}

// The crossings of lines that lie inside and not too near to a loop; those of every second,
// fourth, … line before the others, so that no triangle is long for long.
void SurfaceTessellation::LaySeeds() {
  const auto& u = domain().lines_u();
  const auto& v = domain().lines_v();
  const std::size_t longest = std::max(u.size(), v.size());
  std::size_t stride = 1;
  while (stride < longest) stride *= 2;
  for (bool first = true; stride > 0; stride /= 2, first = false) {
    for (std::size_t i = 0; i < u.size(); i += stride) {
      for (std::size_t j = 0; j < v.size(); j += stride) {
        const bool done = !first && i % (2 * stride) == 0 && j % (2 * stride) == 0;
        if (!done && Wanted(i, j)) mesh_.Insert({u[i], v[j]});
      }
    }
  }
}

bool SurfaceTessellation::Wanted(std::size_t i, std::size_t j) {
  const auto& u = domain().lines_u();
  const auto& v = domain().lines_v();
  const LatticePoint point{u[i], v[j]};
  const ConstrainedDelaunay::Triangle& triangle =
      mesh_.delaunay().triangles()[mesh_.delaunay().Find(point)];
  bool inside = triangle.inside;
  for (int e = 0; e < 3; ++e) {
    const LatticePoint& a = mesh_.delaunay().points()[triangle.vertices[(e + 1) % 3]];
    const LatticePoint& b = mesh_.delaunay().points()[triangle.vertices[(e + 2) % 3]];
    const std::int64_t turn = Turn(a, b, point);
    if (turn == 0) {
      if (!knots_on_border_ && (triangle.odd >> e & 1)) return false;
      inside = inside || mesh_.delaunay().triangles()[triangle.neighbours[e]].inside;
    } else if (triangle.fixed >> e & 1) {
      constexpr double kNear = 1.0 / 8;  // of the way to the nearest line
      const auto gap = [](const std::vector<std::int64_t>& lines, std::size_t k) {
        return std::min(k > 0 ? lines[k] - lines[k - 1] : lines[k + 1] - lines[k],
                        k + 1 < lines.size() ? lines[k + 1] - lines[k] : lines[k] - lines[k - 1]);
      };
      const double length =
          std::hypot(static_cast<double>(b.x - a.x), static_cast<double>(b.y - a.y));
      const double least = static_cast<double>(std::min(gap(u, i), gap(v, j)));
      if (static_cast<double>(turn) < kNear * least * length && !domain().OnBorder(point)) {
        return false;
      }
    }
  }
  return inside;
}

void SurfaceTessellation::LayCreases() {
  const std::int64_t w = domain().width(), h = domain().height();
  const auto lay = [this](const LatticePoint& from, const LatticePoint& to) {
    mesh_.delaunay().FixSegment(mesh_.Insert(from), mesh_.Insert(to), false);
    mesh_.NoteVertices();
  };
  for (const std::int64_t x : domain().creases_u()) lay({x, 0}, {x, h});
  for (const std::int64_t y : domain().creases_v()) lay({0, y}, {w, y});
  for (const auto& [key, vertex] : std::map(mesh_.border())) {
    for (const LatticePoint& same : domain().Mirrored(mesh_.delaunay().points()[vertex]))
      mesh_.Insert(same);
  }
}

void SurfaceTessellation::Queue(int triangle) {
  queued_.resize(mesh_.delaunay().triangles().size(), 0);
  if (queued_[triangle] || !mesh_.delaunay().triangles()[triangle].inside) return;
  queued_[triangle] = 1;
  queue_.push_back(triangle);
}

void SurfaceTessellation::EmptyQueue() {
  constexpr double kShare = 0.8;  // of the tolerance, for what estimates miss
  while (!queue_.empty()) {
    const int triangle = queue_.front();
    queue_.pop_front();
    queued_[triangle] = 0;
    const SurfaceTriangle given = mesh_.SurfaceTriangleOf(mesh_.delaunay().triangles()[triangle]);
    const TriangleError error = ErrorOf(given, evaluator(), tolerance_);
    std::optional<std::array<int, 3>> edges = error.worst;
    if (error.distance <= kShare * tolerance_) edges = Unproven(given);
    if (!edges) continue;
    for (const int edge : *edges) {
      if (Split({triangle, edge})) break;
    }
  }
}

// None where the triangle, and those of its edges that follow the surface as lines, are proven to
// lie within the tolerance; else the edges, those to be halved first in front.
std::optional<std::array<int, 3>> SurfaceTessellation::Unproven(const SurfaceTriangle& triangle) {
  const auto& p = triangle.parameters;
  const auto& q = triangle.points;
  for (int e = 0; e < 3; ++e) {
    if (!triangle.lines[e]) continue;
    const int from = (e + 1) % 3, to = (e + 2) % 3;
    const Eigen::Vector3d direction = (q[to] - q[from]).stableNormalized();
    if (proof_.OffLine(p[from], p[to], q[from], direction, tolerance_)) {
      return std::array<int, 3>{e, from, to};
    }
  }
  // A triangle without a plane takes the surface's own.
  constexpr double kFlat = 1e-12;
  const Eigen::Vector3d cross = (q[1] - q[0]).cross(q[2] - q[0]);
  double longest = 0;
  for (int e = 0; e < 3; ++e) longest = std::max(longest, (q[(e + 1) % 3] - q[e]).norm());
  std::optional<Eigen::Vector3d> normal;
  if (cross.norm() > kFlat * longest * longest) {
    normal = cross.normalized();
  } else {
    const Eigen::Vector2d middle = (p[0] + p[1] + p[2]) / 3;
    normal = evaluator().NormalAt(middle[0], middle[1]);
  }
  if (!normal) return std::nullopt;
  const auto place = proof_.OffPlane(p, *normal, normal->dot(q[0]), tolerance_);
  if (!place) return std::nullopt;
  return EdgesAt(triangle, evaluator(), *place, tolerance_);
}

// Halves the edge, and the same edge on the other side of a seam.
bool SurfaceTessellation::Split(ConstrainedDelaunay::Place place) {
  const auto& v = mesh_.delaunay().triangles()[place.triangle].vertices;
  const int from = v[(place.edge + 1) % 3], to = v[(place.edge + 2) % 3];
  const LatticePoint a = mesh_.delaunay().points()[from], b = mesh_.delaunay().points()[to];
  const LatticePoint middle{(a.x + b.x) / 2, (a.y + b.y) / 2};
  if (middle == a || middle == b) return false;
  const bool border = domain().OnBorder(middle);
  if (!SplitHere(place, middle)) return false;
  if (!border) return true;
  for (const LatticePoint& same : domain().Mirrored(middle)) {
    const LatticePoint shift{same.x - middle.x, same.y - middle.y};
    const int other_a = mesh_.BorderVertex({a.x + shift.x, a.y + shift.y});
    const int other_b = mesh_.BorderVertex({b.x + shift.x, b.y + shift.y});
    if (other_a < 0 || other_b < 0) continue;
    const auto other = mesh_.delaunay().EdgeBetween(other_a, other_b);
    if (other) SplitHere(*other, same);
  }
  return true;
}

bool SurfaceTessellation::SplitHere(ConstrainedDelaunay::Place place, const LatticePoint& middle) {
  const std::optional<int> vertex = mesh_.delaunay().SplitEdge(place, middle);
  if (!vertex) return false;
  mesh_.NoteVertices();
  for (const int changed : mesh_.delaunay().TakeChanged()) Queue(changed);
  const auto count = static_cast<Eigen::Index>(mesh_.delaunay().triangles().size());
  if (count > options_.max_triangles) Refuse();
  constexpr int kOften = 1 << 14;
  if (options_.progress && *vertex % kOften == 0) {
    options_.progress(1 - static_cast<double>(queue_.size()) / static_cast<double>(count));
  }
  return true;
}

// Two edges from a pole, or through seams, may be one in space and still have other triangles
// between them: each gets a vertex of its own. Whether there were any.
bool SurfaceTessellation::SplitDoubledEdges() {
  const std::vector<int> names = mesh_.Names();
  std::map<std::pair<int, int>, std::vector<std::pair<int, int>>> edges;
  for (const ConstrainedDelaunay::Triangle& triangle : mesh_.delaunay().triangles()) {
    if (!triangle.inside) continue;
    const std::array<int, 3>& v = triangle.vertices;
    const int a = names[v[0]], b = names[v[1]], c = names[v[2]];
    if (a == b || b == c || c == a) continue;
    for (int e = 0; e < 3; ++e) {
      const int from = v[e], to = v[(e + 1) % 3];
      if (!domain().OnBorder(mesh_.delaunay().points()[from]) &&
          !domain().OnBorder(mesh_.delaunay().points()[to]))
        continue;
      edges[std::minmax(names[from], names[to])].emplace_back(from, to);
    }
  }
  bool any = false;
  for (const auto& [name, copies] : edges) {
    if (copies.size() <= 2) continue;
    for (const auto& [from, to] : copies) {
      const auto place = mesh_.delaunay().EdgeBetween(from, to);
      if (place && Split(*place)) any = true;
    }
  }
  return any;
}

}  // namespace batten::internal
