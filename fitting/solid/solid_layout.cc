// SPDX-License-Identifier: MIT
#include "batten/fitting/solid_layout.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "batten/fitting/refused_data.h"
#include "fitting/solid/even_triangles.h"
#include "fitting/solid/matching_kernel.h"
#include "fitting/solid/surface_projector.h"
#include "geometry/subdivision/catmull_clark.h"

namespace batten {
using namespace internal;
namespace {

using Quad = std::array<int, 4>;

// How far the angles of a quadrilateral are from right ones: 1 for a square, 0 and less where one
// is flat or folded over.
double Squareness(const Eigen::Matrix3Xd& points, const Quad& quad) {
  double worst = 0;
  Eigen::Vector3d normal =
      (points.col(quad[2]) - points.col(quad[0])).cross(points.col(quad[3]) - points.col(quad[1]));
  for (std::size_t k = 0; k < 4; ++k) {
    const Eigen::Vector3d at = points.col(quad[k]);
    const Eigen::Vector3d next = points.col(quad[(k + 1) % 4]) - at;
    const Eigen::Vector3d back = points.col(quad[(k + 3) % 4]) - at;
    const Eigen::Vector3d turn = next.cross(back);
    double angle = std::atan2(turn.norm(), next.dot(back));
    if (turn.dot(normal) < 0) angle = 2 * std::numbers::pi - angle;
    worst = std::max(worst, std::abs(angle - std::numbers::pi / 2));
  }
  return 1 - worst / (std::numbers::pi / 2);
}

// All triangles in pairs. The dual graph has three edges at every node and no bridge, so it has a
// perfect matching. [Petersen 1891; weights: Edmonds 1965]
std::vector<Quad> Paired(const TriangleSurface& surface) {
  const auto count = int(surface.triangles.cols());
  std::unordered_map<std::int64_t, int> left;
  for (int t = 0; t < count; ++t) {
    for (int k = 0; k < 3; ++k) {
      const int a = surface.triangles(k, t), b = surface.triangles((k + 1) % 3, t);
      left[std::int64_t{a} << 32 | b] = 3 * t + k;
    }
  }
  std::vector<std::array<int, 2>> edges;
  std::vector<int> weights;
  std::vector<Quad> quads;
  for (int t = 0; t < count; ++t) {
    for (int k = 0; k < 3; ++k) {
      const int a = surface.triangles(k, t), b = surface.triangles((k + 1) % 3, t);
      if (a > b) continue;
      const int other = left.at(std::int64_t{b} << 32 | a);
      const int c = surface.triangles((k + 2) % 3, t);
      const int d = surface.triangles((other % 3 + 2) % 3, other / 3);
      if (c == d) continue;
      edges.push_back({t, other / 3});
      const Quad quad = {a, d, b, c};
      constexpr double kUnits = 10000;
      weights.push_back(int(kUnits * std::max(-3.0, Squareness(surface.vertices, quad))));
      quads.push_back(quad);
    }
  }
  std::vector<Quad> paired;
  for (const int e : PerfectMatching(count, edges, weights))
    paired.push_back(quads[std::size_t(e)]);
  if (paired.empty()) throw RefusedData("the triangles can't be paired");
  return paired;
}

// A mesh of quadrilaterals whose edges turn and whose faces collapse until fewer vertices have
// other than four. [Docampo-Sánchez & Haimes 2019]
class QuadImprover {
 public:
  QuadImprover(const Eigen::Matrix3Xd& points,
               std::vector<Quad> quads,
               const SurfaceProjector& projector)
      : projector_(projector),
        points_(points),
        quads_(std::move(quads)),
        around_(std::size_t(points.cols())) {
    for (int q = 0; q < int(quads_.size()); ++q) {
      for (const int v : quads_[std::size_t(q)]) around_[std::size_t(v)].push_back(q);
    }
  }

  // Moves vertices to the middle of their faces', on the surface.
  void Smooth(int rounds) {
    for (int k = 0; k < rounds; ++k) Smooth();
  }

  // Of the worst face.
  double LeastSquareness() const {
    double least = 1;
    for (const Quad& quad : quads_) {
      if (quad[0] >= 0) least = std::min(least, Squareness(points_, quad));
    }
    return least;
  }

  void Improve() {
    constexpr int kRounds = 8, kSmoothings = 3;
    for (int round = 0; round < kRounds; ++round) {
      bool changed = RemoveDoublets();
      changed = CollapseFaces() || changed;
      changed = TurnEdges() || changed;
      for (int k = 0; k < kSmoothings; ++k) Smooth();
      if (!changed) break;
    }
    RemoveDoublets();
    for (int k = 0; k < 2 * kSmoothings; ++k) Smooth();
  }

  QuadMesh Mesh() const {
    std::vector<int> number(around_.size(), -1), kept;
    QuadMesh mesh;
    std::vector<Quad> faces;
    for (const Quad& quad : quads_) {
      if (quad[0] < 0) continue;
      Quad renamed{};
      for (std::size_t k = 0; k < 4; ++k) {
        int& own = number[std::size_t(quad[k])];
        if (own < 0) {
          own = int(kept.size());
          kept.push_back(quad[k]);
        }
        renamed[k] = own;
      }
      faces.push_back(renamed);
    }
    mesh.vertices.resize(3, Eigen::Index(kept.size()));
    mesh.faces.resize(4, Eigen::Index(faces.size()));
    for (std::size_t k = 0; k < kept.size(); ++k)
      mesh.vertices.col(Eigen::Index(k)) = points_.col(kept[k]);
    for (std::size_t k = 0; k < faces.size(); ++k) {
      mesh.faces.col(Eigen::Index(k)) << faces[k][0], faces[k][1], faces[k][2], faces[k][3];
    }
    return mesh;
  }

 private:
  int Valence(int v) const { return int(around_[std::size_t(v)].size()); }

  // How bad a number of edges is: three and five are the least that curvature asks for.
  static int Off(int valence) {
    const int off = valence - 4;
    return off * off + (valence < 3 ? 10 : 0);
  }

  void Remove(int q) {
    for (const int v : quads_[std::size_t(q)]) {
      std::vector<int>& fan = around_[std::size_t(v)];
      fan.erase(std::find(fan.begin(), fan.end(), q));
    }
    quads_[std::size_t(q)] = {-1, -1, -1, -1};
  }

  void Put(int q, const Quad& quad) {
    quads_[std::size_t(q)] = quad;
    for (const int v : quad) around_[std::size_t(v)].push_back(q);
  }

  // The face to the left of the edge from a to b, its corners from a on; −1: none.
  std::pair<int, Quad> LeftOf(int a, int b) const {
    for (const int q : around_[std::size_t(a)]) {
      const Quad& quad = quads_[std::size_t(q)];
      for (std::size_t k = 0; k < 4; ++k) {
        if (quad[k] == a && quad[(k + 1) % 4] == b) {
          return {q, {a, b, quad[(k + 2) % 4], quad[(k + 3) % 4]}};
        }
      }
    }
    return {-1, {}};
  }

  // Whether a new face may stand: four corners, no edge that is there already in its direction.
  bool Allowed(const Quad& quad) const {
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t m = 0; m < k; ++m) {
        if (quad[k] == quad[m]) return false;
      }
      if (LeftOf(quad[k], quad[(k + 1) % 4]).first >= 0) return false;
    }
    return true;
  }

  static bool Even(const Eigen::Matrix3Xd& points, const Quad& quad) {
    constexpr double kLeast = -0.2;  // smoothing mends what is a little past flat
    return Squareness(points, quad) > kLeast;
  }

  bool RemoveDoublets() {
    bool changed = false;
    for (int v = 0; v < int(around_.size()); ++v) {
      if (Valence(v) != 2) continue;
      const int one = around_[std::size_t(v)][0], two = around_[std::size_t(v)][1];
      const auto corners = [&](int q) {
        Quad quad = quads_[std::size_t(q)];
        std::rotate(quad.begin(), std::find(quad.begin(), quad.end(), v), quad.end());
        return quad;
      };
      const Quad a = corners(one), b = corners(two);
      const Quad merged = {a[1], a[2], a[3], b[2]};
      if (a[2] == b[2]) continue;
      Remove(one);
      Remove(two);
      if (Allowed(merged)) {
        Put(one, merged);
        changed = true;
      } else {
        Put(one, a);
        Put(two, b);
      }
    }
    return changed;
  }

  // Joins opposite corners of a face where that helps.
  bool CollapseFaces() {
    bool changed = false;
    for (int q = 0; q < int(quads_.size()); ++q) {
      for (std::size_t k = 0; k < 2 && quads_[std::size_t(q)][0] >= 0; ++k) {
        const Quad quad = quads_[std::size_t(q)];
        changed = Collapse(q, quad[k], quad[k + 1], quad[k + 2], quad[(k + 3) % 4]) || changed;
      }
    }
    return changed;
  }

  bool Collapse(int q, int a, int b, int c, int d) {
    const int joined = Valence(a) + Valence(c) - 2;
    const int before = Off(Valence(a)) + Off(Valence(b)) + Off(Valence(c)) + Off(Valence(d));
    const int after = Off(joined) + Off(Valence(b) - 1) + Off(Valence(d) - 1);
    if (after >= before || Valence(b) < 4 || Valence(d) < 4) return false;
    // Neighbours of a and c other than b and d must differ, else faces would stand on one another.
    std::vector<int> near;
    for (const int f : around_[std::size_t(a)]) {
      for (const int v : quads_[std::size_t(f)]) near.push_back(v);
    }
    for (const int f : around_[std::size_t(c)]) {
      if (f == q) continue;
      for (const int v : quads_[std::size_t(f)]) {
        if (v != b && v != c && v != d && std::find(near.begin(), near.end(), v) != near.end())
          return false;
      }
    }
    const Eigen::Vector3d old_a = points_.col(a), old_c = points_.col(c);
    points_.col(a) = points_.col(c) = projector_.Nearest((old_a + old_c) / 2);
    for (const int end : {a, c}) {
      for (const int f : around_[std::size_t(end)]) {
        if (f == q || Even(points_, quads_[std::size_t(f)])) continue;
        points_.col(a) = old_a;
        points_.col(c) = old_c;
        return false;
      }
    }
    Remove(q);
    const std::vector<int> moved = around_[std::size_t(c)];
    for (const int f : moved) {
      Quad face = quads_[std::size_t(f)];
      Remove(f);
      std::replace(face.begin(), face.end(), c, a);
      Put(f, face);
    }
    return true;
  }

  bool TurnEdges() {
    bool changed = false;
    for (int q = 0; q < int(quads_.size()); ++q) {
      for (std::size_t k = 0; k < 4 && quads_[std::size_t(q)][0] >= 0; ++k) {
        const Quad quad = quads_[std::size_t(q)];
        changed = TurnEdge(quad[k], quad[(k + 1) % 4]) || changed;
      }
    }
    return changed;
  }

  // The diagonal of the hexagon of two faces moves on by one corner, to either side.
  bool TurnEdge(int a, int b) {
    const auto [left, one] = LeftOf(a, b);
    const auto [right, two] = LeftOf(b, a);
    if (left < 0 || right < 0 || left == right) return false;
    // The hexagon b, c, d, a, e, f.
    const std::array<int, 6> ring = {b, one[2], one[3], a, two[2], two[3]};
    const auto gain = [&](int p, int r) {
      return Off(Valence(a)) + Off(Valence(b)) + Off(Valence(p)) + Off(Valence(r)) -
             Off(Valence(a) - 1) - Off(Valence(b) - 1) - Off(Valence(p) + 1) - Off(Valence(r) + 1);
    };
    const int first = gain(ring[1], ring[4]), second = gain(ring[2], ring[5]);
    for (const bool forward : first >= second ? std::array{true, false} : std::array{false, true}) {
      if ((forward ? first : second) <= 0) continue;
      const std::size_t s = forward ? 1 : 2;
      const auto at = [&](std::size_t k) { return ring[(s + k) % 6]; };
      const Quad three = {at(0), at(1), at(2), at(3)}, four = {at(3), at(4), at(5), at(0)};
      if (!Even(points_, three) || !Even(points_, four)) continue;
      Remove(left);
      Remove(right);
      // The second is asked for after the first stands; the edge between is in both directions.
      if (Allowed(three)) {
        Put(left, three);
        if (Allowed(four)) {
          Put(right, four);
          return true;
        }
        Remove(left);
      }
      Put(left, one);
      Put(right, two);
    }
    return false;
  }

  void Smooth() {
    Eigen::Matrix3Xd moved = points_;
    for (int v = 0; v < int(around_.size()); ++v) {
      if (around_[std::size_t(v)].empty()) continue;
      Eigen::Vector3d middle = Eigen::Vector3d::Zero();
      for (const int q : around_[std::size_t(v)]) {
        Eigen::Vector3d centre = Eigen::Vector3d::Zero();
        for (const int corner : quads_[std::size_t(q)]) centre += points_.col(corner) / 4;
        middle += centre / double(Valence(v));
      }
      constexpr double kShare = 0.6;
      const Eigen::Vector3d at = points_.col(v);
      moved.col(v) = projector_.Nearest(at + kShare * (middle - at));
    }
    points_ = std::move(moved);
  }

  const SurfaceProjector& projector_;
  Eigen::Matrix3Xd points_;
  std::vector<Quad> quads_;
  std::vector<std::vector<int>> around_;
};

}  // namespace

namespace {

// Angles of 14° to 166° at least: where a coarse layout does not follow the shape, faces fold.
constexpr double kEven = 0.15;

int EulerOf(const QuadMesh& mesh) {
  return static_cast<int>(mesh.vertices.cols()) - static_cast<int>(mesh.faces.cols());
}

// A layout of about so many faces; throws std::invalid_argument where none of that Euler number
// comes out.
QuadMesh PairedLayout(const TriangleSurface& surface,
                      const SurfaceProjector& projector,
                      double faces,
                      int euler,
                      double least_squareness,
                      const Progress& progress) {
  // Two triangles to a face; those of even size have edges of this length.
  const double length = std::sqrt(2 * AreaOf(surface) / (std::sqrt(3.0) * faces));
  const TriangleSurface even = EvenTriangles(surface, projector, length, progress);
  QuadImprover improver(even.vertices, Paired(even), projector);
  improver.Improve();
  if (improver.LeastSquareness() < least_squareness) throw RefusedData("a face is too uneven");
  QuadMesh layout = improver.Mesh();
  CheckQuadMesh(layout);
  if (EulerOf(layout) != euler) throw RefusedData("its genus differs from the surface's");
  return layout;
}

// The layout with every face cut in four, on the surface; faces that come out uneven are refused.
QuadMesh Finer(const QuadMesh& layout, const SurfaceProjector& projector) {
  const SubdividedMesh finer =
      Subdivided(QuadTopology(layout.faces, static_cast<int>(layout.vertices.cols())));
  Eigen::Matrix3Xd points = Combined(finer.stencils, layout.vertices);
  for (Eigen::Index v = 0; v < points.cols(); ++v) points.col(v) = projector.Nearest(points.col(v));
  std::vector<Quad> quads;
  for (const auto face : finer.topology.corners().colwise()) {
    quads.push_back({face[0], face[1], face[2], face[3]});
  }
  QuadImprover improver(points, std::move(quads), projector);
  constexpr int kSmoothings = 10;
  improver.Smooth(kSmoothings);
  if (improver.LeastSquareness() < kEven) throw RefusedData("a face is too uneven");
  QuadMesh mesh = improver.Mesh();
  CheckQuadMesh(mesh);
  return mesh;
}

}  // namespace

QuadMesh LayoutOf(const TriangleSurface& surface, int faces, const Progress& progress) {
  if (faces < 6) throw RefusedData("a layout of fewer than six faces closes nothing");
  const SurfaceProjector projector(surface);
  // V − E + F of a closed surface of triangles is V − F/2, of quadrilaterals V − F.
  const int euler = static_cast<int>(surface.vertices.cols() - surface.triangles.cols() / 2);
  std::string why;
  // A coarse layout cut finer has fewer extraordinary vertices, where its faces are fine enough for
  // the shape; a layout finer than asked for may be where those are not.
  for (const double coarse : {16.0, 4.0, 1.0, 0.6}) {
    constexpr double kAny = -3;     // least of all squarenesses; the fit judges
    constexpr double kFewest = 40;  // faces of a coarse layout
    if (coarse > 1 && faces / coarse < kFewest) continue;
    Report(progress, "layout", 0.0);
    try {
      QuadMesh layout = PairedLayout(
          surface, projector, faces / coarse, euler, coarse > 1 ? kEven : kAny, progress);
      for (double cut = coarse; cut > 1; cut /= 4) layout = Finer(layout, projector);
      return layout;
    } catch (const std::invalid_argument& fault) {
      why = fault.what();
    }
  }
  throw RefusedData("no layout of quadrilaterals comes out (" + why + "): give one");
}

int LayoutFaces(Eigen::Index points, bool measured) {
  // Vertices of a mesh stand where its shape asks for them, and have less noise than points.
  const Eigen::Index each = measured ? 4 : 6;
  constexpr Eigen::Index kLeast = 60, kMost = 2500;  // beyond, a fit takes more than a minute
  return int(std::clamp(points / each, kLeast, kMost));
}

}  // namespace batten
