// SPDX-License-Identifier: MIT
#include "batten/geometry/tessellate.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "batten/geometry/bounding_box.h"
#include "batten/geometry/surface_evaluator.h"
#include "batten/geometry/trim_region.h"
#include "geometry/measure/narrow_spans.h"
#include "geometry/mesh/mesh_domain.h"
#include "geometry/mesh/triangle_error.h"
#include "geometry/mesh/triangle_proof.h"
#include "geometry/numeric/constrained_delaunay.h"
#include "geometry/numeric/number_text.h"

namespace batten {
using namespace internal;
namespace {

using Key = std::pair<std::int64_t, std::int64_t>;
Key KeyOf(const LatticePoint& point) { return {point.x, point.y}; }

// One tessellation under way; everything about the middle of the surface's box.
class Tessellation {
 public:
  Tessellation(const NurbsSurface& surface,
               const Eigen::Vector3d& middle,
               double tolerance,
               const TessellateOptions& options)
      : middle_(middle),
        surface_(surface.Translated(-middle)),
        region_(surface_.surface()),
        domain_(surface_.surface()),
        proof_(surface_.surface()),
        tolerance_(tolerance),
        options_(options) {}

  TriangleMesh Run() {
    RefuseTooMany();
    LayLoops();
    LaySeeds();
    LayCreases();
    mesh_.FindInside();
    mesh_.TakeChanged();
    for (std::size_t t = 0; t < mesh_.triangles().size(); ++t) Queue(static_cast<int>(t));
    Refine();
    while (SplitDoubledEdges()) Refine();
    return Extracted();
  }

 private:
  const NurbsSurface& surface() const { return surface_.surface(); }

  // An estimate from below the middle of spans, before any work.
  void RefuseTooMany() const {
    constexpr double kSlack = 8;  // of the estimate
    const auto& u = domain_.lines_u();
    const auto& v = domain_.lines_v();
    double triangles = 0;
    for (std::size_t i = 0; i + 1 < u.size(); ++i) {
      for (std::size_t j = 0; j + 1 < v.size(); ++j) {
        const Eigen::Vector2d lower = domain_.ParameterOf({u[i], v[j]});
        const Eigen::Vector2d upper = domain_.ParameterOf({u[i + 1], v[j + 1]});
        if (surface().trimmed() && region_.CoverOf({lower[0], upper[0], lower[1], upper[1]}) ==
                                       TrimRegion::Cover::kOutside) {
          continue;
        }
        const Eigen::Vector2d at = (lower + upper) / 2, size = upper - lower;
        const SurfaceJet jet = surface_.JetAt(at[0], at[1]);
        const Eigen::Vector3d normal = jet.du.cross(jet.dv).normalized();
        const double bend_u = std::abs(normal.dot(jet.duu)) * size[0] * size[0] / 8;
        const double bend_v = std::abs(normal.dot(jet.dvv)) * size[1] * size[1] / 8;
        triangles += 2 * std::max(std::sqrt(bend_u / tolerance_) / kSlack, 1.0) *
                     std::max(std::sqrt(bend_v / tolerance_) / kSlack, 1.0);
      }
    }
    if (triangles > static_cast<double>(options_.max_triangles)) Refuse();
  }

  [[noreturn]] void Refuse() const {
    throw std::invalid_argument("Tessellate: options.chord_tolerance: " + NumberText(tolerance_) +
                                " needs more than the " + std::to_string(options_.max_triangles) +
                                " triangles of options.max_triangles");
  }

  int Insert(const LatticePoint& point) {
    const int vertex = mesh_.Insert(point);
    NoteVertex(vertex);
    return vertex;
  }

  // Knows the vertex and those before it: where they are, and who is on the border.
  void NoteVertex(int vertex) {
    constexpr int kCorners = 4;
    for (int k = static_cast<int>(points_.size()); k <= vertex; ++k) {
      const LatticePoint& place = mesh_.points()[k];
      parameters_.push_back(
          k < kCorners ? Eigen::Vector2d(surface().basis_u().lower(), surface().basis_v().lower())
                       : domain_.ParameterOf(place));
      points_.push_back(surface_.At(parameters_[k][0], parameters_[k][1]));
      if (k >= kCorners && domain_.OnBorder(place)) border_[KeyOf(place)] = k;
    }
  }

  void LayLoops() {
    std::vector<std::vector<int>> chains;
    const std::int64_t w = domain_.width(), h = domain_.height();
    if (!surface().trimmed()) {
      chains.push_back({Insert({0, 0}), Insert({w, 0}), Insert({w, h}), Insert({0, h})});
    }
    for (const NurbsCurve<2>& loop : surface().trims()) {
      chains.emplace_back();
      for (const Eigen::Vector2d& place : LoopVertices(loop, surface_, tolerance_ / 2)) {
        const LatticePoint point = domain_.Snap(place);
        const int vertex = Insert(point);
        chains.back().push_back(vertex);
        if (!domain_.OnBorder(point)) MoveVertex(vertex, place);
        for (const LatticePoint& mirrored : domain_.Mirrored(point)) Insert(mirrored);
      }
    }
    for (const std::vector<int>& chain : chains) {
      for (std::size_t k = 0; k < chain.size(); ++k) {
        mesh_.FixSegment(chain[k], chain[(k + 1) % chain.size()], true);
      }
    }
    NoteVertex(static_cast<int>(mesh_.points().size()) - 1);
    mesh_.FindInside();
  }

  // Loops keep their own parameters, exactly.
  void MoveVertex(int vertex, const Eigen::Vector2d& parameter) {
    parameters_[vertex] = parameter;
    points_[vertex] = surface_.At(parameter[0], parameter[1]);
  }

  // The crossings of lines that lie inside and not too near to a loop; those of every second,
  // fourth, … line before the others, so that no triangle is long for long.
  void LaySeeds() {
    const auto& u = domain_.lines_u();
    const auto& v = domain_.lines_v();
    const std::size_t longest = std::max(u.size(), v.size());
    std::size_t stride = 1;
    while (stride < longest) stride *= 2;
    for (bool first = true; stride > 0; stride /= 2, first = false) {
      for (std::size_t i = 0; i < u.size(); i += stride) {
        for (std::size_t j = 0; j < v.size(); j += stride) {
          const bool done = !first && i % (2 * stride) == 0 && j % (2 * stride) == 0;
          if (!done && Wanted(i, j)) Insert({u[i], v[j]});
        }
      }
    }
  }

  bool Wanted(std::size_t i, std::size_t j) {
    const auto& u = domain_.lines_u();
    const auto& v = domain_.lines_v();
    const LatticePoint point{u[i], v[j]};
    const ConstrainedDelaunay::Triangle& triangle = mesh_.triangles()[mesh_.Find(point)];
    bool inside = triangle.inside;
    for (int e = 0; e < 3; ++e) {
      const LatticePoint& a = mesh_.points()[triangle.vertices[(e + 1) % 3]];
      const LatticePoint& b = mesh_.points()[triangle.vertices[(e + 2) % 3]];
      const std::int64_t turn = Turn(a, b, point);
      if (turn == 0) {
        inside = inside || mesh_.triangles()[triangle.neighbours[e]].inside;
      } else if (triangle.fixed >> e & 1) {
        constexpr double kNear = 1.0 / 8;  // of the way to the nearest line
        const auto gap = [](const std::vector<std::int64_t>& lines, std::size_t k) {
          return std::min(k > 0 ? lines[k] - lines[k - 1] : lines[k + 1] - lines[k],
                          k + 1 < lines.size() ? lines[k + 1] - lines[k] : lines[k] - lines[k - 1]);
        };
        const double length =
            std::hypot(static_cast<double>(b.x - a.x), static_cast<double>(b.y - a.y));
        const double least = static_cast<double>(std::min(gap(u, i), gap(v, j)));
        if (static_cast<double>(turn) < kNear * least * length && !domain_.OnBorder(point)) {
          return false;
        }
      }
    }
    return inside;
  }

  void LayCreases() {
    const std::int64_t w = domain_.width(), h = domain_.height();
    const auto lay = [this](const LatticePoint& from, const LatticePoint& to) {
      mesh_.FixSegment(Insert(from), Insert(to), false);
      NoteVertex(static_cast<int>(mesh_.points().size()) - 1);
    };
    for (const std::int64_t x : domain_.creases_u()) lay({x, 0}, {x, h});
    for (const std::int64_t y : domain_.creases_v()) lay({0, y}, {w, y});
    for (const auto& [key, vertex] : std::map<Key, int>(border_)) {
      for (const LatticePoint& same : domain_.Mirrored(mesh_.points()[vertex])) Insert(same);
    }
  }

  void Queue(int triangle) {
    queued_.resize(mesh_.triangles().size(), 0);
    if (queued_[triangle] || !mesh_.triangles()[triangle].inside) return;
    queued_[triangle] = 1;
    queue_.push_back(triangle);
  }

  void Refine() {
    constexpr double kShare = 0.8;  // of the tolerance, for what estimates miss
    while (!queue_.empty()) {
      const int triangle = queue_.front();
      queue_.pop_front();
      queued_[triangle] = 0;
      const SurfaceTriangle given = SurfaceTriangleOf(mesh_.triangles()[triangle]);
      const TriangleError error = ErrorOf(given, surface_, tolerance_);
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
  std::optional<std::array<int, 3>> Unproven(const SurfaceTriangle& triangle) {
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
      normal = surface_.NormalAt(middle[0], middle[1]);
    }
    if (!normal) return std::nullopt;
    const auto place = proof_.OffPlane(p, *normal, normal->dot(q[0]), tolerance_);
    if (!place) return std::nullopt;
    return EdgesAt(triangle, surface_, *place, tolerance_);
  }

  SurfaceTriangle SurfaceTriangleOf(const ConstrainedDelaunay::Triangle& triangle) const {
    SurfaceTriangle result;
    for (int e = 0; e < 3; ++e) {
      const int vertex = triangle.vertices[e];
      result.parameters[e] = parameters_[vertex];
      result.points[e] = points_[vertex];
      const LatticePoint& a = mesh_.points()[triangle.vertices[(e + 1) % 3]];
      const LatticePoint& b = mesh_.points()[triangle.vertices[(e + 2) % 3]];
      const bool seam =
          (domain_.closed_u() && a.x == b.x && (a.x == 0 || a.x == domain_.width())) ||
          (domain_.closed_v() && a.y == b.y && (a.y == 0 || a.y == domain_.height()));
      result.lines[e] = (triangle.fixed >> e & 1) && !seam;
    }
    return result;
  }

  // Halves the edge, and the same edge on the other side of a seam.
  bool Split(ConstrainedDelaunay::Place place) {
    const auto& v = mesh_.triangles()[place.triangle].vertices;
    const int from = v[(place.edge + 1) % 3], to = v[(place.edge + 2) % 3];
    const LatticePoint a = mesh_.points()[from], b = mesh_.points()[to];
    const LatticePoint middle{(a.x + b.x) / 2, (a.y + b.y) / 2};
    if (middle == a || middle == b) return false;
    const bool border = domain_.OnBorder(middle);
    if (!SplitHere(place, middle)) return false;
    if (!border) return true;
    for (const LatticePoint& same : domain_.Mirrored(middle)) {
      const LatticePoint shift{same.x - middle.x, same.y - middle.y};
      const auto other_a = border_.find({a.x + shift.x, a.y + shift.y});
      const auto other_b = border_.find({b.x + shift.x, b.y + shift.y});
      if (other_a == border_.end() || other_b == border_.end()) continue;
      const auto other = mesh_.EdgeBetween(other_a->second, other_b->second);
      if (other) SplitHere(*other, same);
    }
    return true;
  }

  bool SplitHere(ConstrainedDelaunay::Place place, const LatticePoint& middle) {
    const std::optional<int> vertex = mesh_.SplitEdge(place, middle);
    if (!vertex) return false;
    NoteVertex(*vertex);
    for (const int changed : mesh_.TakeChanged()) Queue(changed);
    const auto count = static_cast<Eigen::Index>(mesh_.triangles().size());
    if (count > options_.max_triangles) Refuse();
    constexpr int kOften = 1 << 14;
    if (options_.progress && *vertex % kOften == 0) {
      options_.progress(1 - static_cast<double>(queue_.size()) / static_cast<double>(count));
    }
    return true;
  }

  // Vertices that are one point of the surface get one name: the first of them.
  std::vector<int> Names() const {
    std::vector<int> names(points_.size());
    for (std::size_t k = 0; k < names.size(); ++k) names[k] = static_cast<int>(k);
    std::map<Key, int> first;
    for (const auto& [key, vertex] : border_) {
      names[vertex] =
          first.emplace(KeyOf(domain_.Canonical({key.first, key.second})), vertex).first->second;
    }
    return names;
  }

  // Two edges from a pole, or through seams, may be one in space and still have other triangles
  // between them: each gets a vertex of its own. Whether there were any.
  bool SplitDoubledEdges() {
    const std::vector<int> names = Names();
    std::map<std::pair<int, int>, std::vector<std::pair<int, int>>> edges;
    for (const ConstrainedDelaunay::Triangle& triangle : mesh_.triangles()) {
      if (!triangle.inside) continue;
      const std::array<int, 3>& v = triangle.vertices;
      const int a = names[v[0]], b = names[v[1]], c = names[v[2]];
      if (a == b || b == c || c == a) continue;
      for (int e = 0; e < 3; ++e) {
        const int from = v[e], to = v[(e + 1) % 3];
        if (!domain_.OnBorder(mesh_.points()[from]) && !domain_.OnBorder(mesh_.points()[to]))
          continue;
        edges[std::minmax(names[from], names[to])].emplace_back(from, to);
      }
    }
    bool any = false;
    for (const auto& [name, copies] : edges) {
      if (copies.size() <= 2) continue;
      for (const auto& [from, to] : copies) {
        const auto place = mesh_.EdgeBetween(from, to);
        if (place && Split(*place)) any = true;
      }
    }
    return any;
  }

  TriangleMesh Extracted() const {
    const std::vector<int> names = Names();
    std::vector<int> numbers(names.size(), -1);
    std::vector<int> used;
    std::vector<Eigen::Vector3i> triangles;
    std::vector<std::array<int, 3>> own;  // their vertices as they were before they got names
    for (const ConstrainedDelaunay::Triangle& triangle : mesh_.triangles()) {
      if (!triangle.inside) continue;
      Eigen::Vector3i named;
      for (int e = 0; e < 3; ++e) named[e] = names[triangle.vertices[e]];
      if (named[0] == named[1] || named[1] == named[2] || named[2] == named[0]) continue;
      for (int& vertex : named) {
        if (numbers[vertex] < 0) {
          numbers[vertex] = static_cast<int>(used.size());
          used.push_back(vertex);
        }
        vertex = numbers[vertex];
      }
      triangles.push_back(named);
      own.push_back(triangle.vertices);
    }
    TriangleMesh mesh;
    const auto count = static_cast<Eigen::Index>(used.size());
    mesh.vertices.resize(3, count);
    mesh.parameters.resize(2, count);
    mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
    for (Eigen::Index k = 0; k < count; ++k) {
      mesh.vertices.col(k) = points_[used[k]];
      mesh.parameters.col(k) = parameters_[used[k]];
    }
    for (std::size_t k = 0; k < triangles.size(); ++k) mesh.triangles.col(k) = triangles[k];
    AddNormals(mesh, Ambiguous(names, numbers, count));
    AddSides(mesh, own);
    mesh.vertices.colwise() += middle_;
    return mesh;
  }

  // Which vertices of the mesh stand for places with different normals: tips, creased seams.
  std::vector<char> Ambiguous(const std::vector<int>& names,
                              const std::vector<int>& numbers,
                              Eigen::Index count) const {
    constexpr double kAlike = 1 - 1e-6;  // the cosine
    std::vector<char> ambiguous(count, 0);
    for (const auto& [key, vertex] : border_) {
      const int name = names[vertex];
      if (name == vertex || numbers[name] < 0) continue;
      const auto first = surface_.NormalAt(parameters_[name][0], parameters_[name][1]);
      const auto other = surface_.NormalAt(parameters_[vertex][0], parameters_[vertex][1]);
      if (first && other && first->dot(*other) < kAlike) ambiguous[numbers[name]] = 1;
    }
    return ambiguous;
  }

  // Where the surface has no normal, or several, the mean of the triangles around.
  void AddNormals(TriangleMesh& mesh, const std::vector<char>& ambiguous) const {
    mesh.normals.setZero(3, mesh.vertices.cols());
    for (const auto triangle : mesh.triangles.colwise()) {
      const Eigen::Vector3d a = mesh.vertices.col(triangle[0]);
      const Eigen::Vector3d normal =
          (mesh.vertices.col(triangle[1]) - a)
              .cross(Eigen::Vector3d(mesh.vertices.col(triangle[2]) - a));
      for (const int vertex : triangle) mesh.normals.col(vertex) += normal;
    }
    for (Eigen::Index k = 0; k < mesh.normals.cols(); ++k) {
      const auto normal = surface_.NormalAt(mesh.parameters(0, k), mesh.parameters(1, k));
      if (normal && !ambiguous[k]) {
        mesh.normals.col(k) = *normal;
      } else {
        mesh.normals.col(k) = mesh.normals.col(k).stableNormalized().eval();
      }
    }
  }

  // Whether the point lies where triangles around it may see it differently.
  bool ManySided(const LatticePoint& point) const {
    const auto on = [](const std::vector<std::int64_t>& lines, std::int64_t at) {
      return std::binary_search(lines.begin(), lines.end(), at);
    };
    return domain_.OnBorder(point) || on(domain_.creases_u(), point.x) ||
           on(domain_.creases_v(), point.y);
  }

  // Notes the corners whose parameters or normals are not those of their vertices.
  void AddSides(TriangleMesh& mesh, const std::vector<std::array<int, 3>>& own) const {
    constexpr double kAlike = 1 - 1e-6;     // the cosine
    constexpr double kInwards = 1e-7;       // of the way to the triangle's middle: on its side
    std::map<int, std::vector<int>> sides;  // of each vertex before it got its name
    for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
      const std::array<int, 3>& corners = own[static_cast<std::size_t>(t)];
      const Eigen::Vector2d centre =
          (parameters_[corners[0]] + parameters_[corners[1]] + parameters_[corners[2]]) / 3;
      for (int e = 0; e < 3; ++e) {
        const int corner = corners[e], vertex = mesh.triangles(e, t);
        if (!ManySided(mesh_.points()[corner])) continue;
        const Eigen::Vector2d& parameter = parameters_[corner];
        const Eigen::Vector2d inside = parameter + kInwards * (centre - parameter);
        const Eigen::Vector3d usual = mesh.normals.col(vertex);
        const Eigen::Vector3d normal = surface_.NormalAt(inside[0], inside[1]).value_or(usual);
        if (parameter == mesh.parameters.col(vertex) && normal.dot(usual) > kAlike) continue;
        std::vector<int>& known = sides[corner];
        const auto same = std::find_if(known.begin(), known.end(), [&](int side) {
          return mesh.other_sides[side].normal.dot(normal) > kAlike;
        });
        int side = static_cast<int>(mesh.other_sides.size());
        if (same != known.end()) {
          side = *same;
        } else {
          known.push_back(side);
          mesh.other_sides.push_back({vertex, parameter, normal});
        }
        mesh.side_corners.push_back({static_cast<int>(t), e, side});
      }
    }
  }

  Eigen::Vector3d middle_;
  SurfaceEvaluator surface_;
  TrimRegion region_;
  MeshDomain domain_;
  TriangleProof proof_;
  double tolerance_;
  const TessellateOptions& options_;
  ConstrainedDelaunay mesh_;
  std::vector<Eigen::Vector2d> parameters_;  // of the vertices
  std::vector<Eigen::Vector3d> points_;
  std::map<Key, int> border_;  // the vertices on the border of the domain
  std::deque<int> queue_;
  std::vector<char> queued_;
};

}  // namespace

TriangleMesh Tessellate(const NurbsSurface& surface, const TessellateOptions& options) {
  if (!(options.chord_tolerance >= 0) || !std::isfinite(options.chord_tolerance)) {
    throw std::invalid_argument("Tessellate: options.chord_tolerance: " +
                                NumberText(options.chord_tolerance) + " is not a number ≥ 0");
  }
  if (options.max_triangles <= 0) {
    throw std::invalid_argument("Tessellate: options.max_triangles: " +
                                std::to_string(options.max_triangles) + " is not positive");
  }
  const Eigen::AlignedBox3d box = BoundingBox(surface);
  const double size = box.diagonal().norm();
  constexpr double kDefault = 1e-3;
  const double tolerance = options.chord_tolerance > 0 ? options.chord_tolerance : kDefault * size;
  if (!(tolerance > 0)) {
    throw std::invalid_argument("Tessellate: surface: all of it is one point");
  }
  RefuseNarrowSpans("Tessellate", surface, tolerance);
  return Tessellation(surface, box.center(), tolerance, options).Run();
}

TriangleMesh JoinedMeshes(const std::vector<TriangleMesh>& meshes) {
  Eigen::Index vertices = 0, triangles = 0;
  for (const TriangleMesh& mesh : meshes) {
    vertices += mesh.vertices.cols();
    triangles += mesh.triangles.cols();
  }
  TriangleMesh all;
  all.vertices.resize(3, vertices);
  all.parameters.resize(2, vertices);
  all.normals.resize(3, vertices);
  all.triangles.resize(3, triangles);
  Eigen::Index vertex = 0, triangle = 0;
  for (const TriangleMesh& mesh : meshes) {
    all.vertices.middleCols(vertex, mesh.vertices.cols()) = mesh.vertices;
    all.parameters.middleCols(vertex, mesh.vertices.cols()) = mesh.parameters;
    all.normals.middleCols(vertex, mesh.vertices.cols()) = mesh.normals;
    all.triangles.middleCols(triangle, mesh.triangles.cols()) =
        mesh.triangles.array() + static_cast<int>(vertex);
    const int side = static_cast<int>(all.other_sides.size());
    for (OtherSide other : mesh.other_sides) {
      other.vertex += static_cast<int>(vertex);
      all.other_sides.push_back(other);
    }
    for (SideCorner corner : mesh.side_corners) {
      corner.triangle += static_cast<int>(triangle);
      corner.side += side;
      all.side_corners.push_back(corner);
    }
    vertex += mesh.vertices.cols();
    triangle += mesh.triangles.cols();
  }
  return all;
}

}  // namespace batten
