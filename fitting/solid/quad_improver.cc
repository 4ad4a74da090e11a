// SPDX-License-Identifier: MIT
#include "fitting/solid/quad_improver.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace batten::internal {

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

QuadImprover::QuadImprover(const QuadMesh& mesh, const SurfaceProjector& projector)
    : projector_(projector),
      points_(mesh.vertices),
      creases_(mesh.creases),
      held_(std::size_t(mesh.vertices.cols()), 0),
      around_(std::size_t(mesh.vertices.cols())) {
  for (const int v : creases_.reshaped()) held_[std::size_t(v)] = 1;
  for (const auto face : mesh.faces.colwise())
    quads_.push_back({face[0], face[1], face[2], face[3]});
  for (int q = 0; q < int(quads_.size()); ++q) {
    for (const int v : quads_[std::size_t(q)]) around_[std::size_t(v)].push_back(q);
  }
}

void QuadImprover::Smooth(int rounds) {
  for (int k = 0; k < rounds; ++k) Smooth();
}

double QuadImprover::LeastSquareness() const {
  double least = 1;
  for (const Quad& quad : quads_) {
    if (quad[0] >= 0) least = std::min(least, Squareness(points_, quad));
  }
  return least;
}

void QuadImprover::Improve() {
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

QuadMesh QuadImprover::Mesh() const {
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
  mesh.creases = creases_.unaryExpr([&](int v) { return number[std::size_t(v)]; });
  return mesh;
}

int QuadImprover::Off(int valence) {
  const int off = valence - 4;
  return off * off + (valence < 3 ? 10 : 0);
}

void QuadImprover::Remove(int q) {
  for (const int v : quads_[std::size_t(q)]) {
    std::vector<int>& fan = around_[std::size_t(v)];
    fan.erase(std::find(fan.begin(), fan.end(), q));
  }
  quads_[std::size_t(q)] = {-1, -1, -1, -1};
}

void QuadImprover::Put(int q, const Quad& quad) {
  quads_[std::size_t(q)] = quad;
  for (const int v : quad) around_[std::size_t(v)].push_back(q);
}

std::pair<int, Quad> QuadImprover::LeftOf(int a, int b) const {
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

bool QuadImprover::Allowed(const Quad& quad) const {
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t m = 0; m < k; ++m) {
      if (quad[k] == quad[m]) return false;
    }
    if (LeftOf(quad[k], quad[(k + 1) % 4]).first >= 0) return false;
  }
  return true;
}

bool QuadImprover::Even(const Eigen::Matrix3Xd& points, const Quad& quad) {
  constexpr double kLeast = -0.2;  // smoothing mends what is a little past flat
  return Squareness(points, quad) > kLeast;
}

bool QuadImprover::RemoveDoublets() {
  bool changed = false;
  for (int v = 0; v < int(around_.size()); ++v) {
    if (Valence(v) != 2 || Held(v)) continue;
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

bool QuadImprover::CollapseFaces() {
  bool changed = false;
  for (int q = 0; q < int(quads_.size()); ++q) {
    for (std::size_t k = 0; k < 2 && quads_[std::size_t(q)][0] >= 0; ++k) {
      const Quad quad = quads_[std::size_t(q)];
      changed = Collapse(q, quad[k], quad[k + 1], quad[k + 2], quad[(k + 3) % 4]) || changed;
    }
  }
  return changed;
}

bool QuadImprover::Collapse(int q, int a, int b, int c, int d) {
  if (Held(a) && Held(c)) return false;
  if (Held(c)) return Collapse(q, c, d, a, b);
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
  points_.col(a) = points_.col(c) = Held(a) ? old_a : projector_.Nearest((old_a + old_c) / 2);
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

bool QuadImprover::TurnEdges() {
  bool changed = false;
  for (int q = 0; q < int(quads_.size()); ++q) {
    for (std::size_t k = 0; k < 4 && quads_[std::size_t(q)][0] >= 0; ++k) {
      const Quad quad = quads_[std::size_t(q)];
      changed = TurnEdge(quad[k], quad[(k + 1) % 4]) || changed;
    }
  }
  return changed;
}

bool QuadImprover::TurnEdge(int a, int b) {
  if (Held(a) && Held(b)) return false;
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

double QuadImprover::LeastSquarenessAbout(int v) const {
  double least = 1;
  for (const int q : around_[std::size_t(v)]) {
    least = std::min(least, Squareness(points_, quads_[std::size_t(q)]));
  }
  return least;
}

// A vertex stays where it is if a face would become uneven.
void QuadImprover::Smooth() {
  for (int v = 0; v < int(around_.size()); ++v) {
    if (around_[std::size_t(v)].empty() || Held(v)) continue;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const int q : around_[std::size_t(v)]) {
      Eigen::Vector3d centre = Eigen::Vector3d::Zero();
      for (const int corner : quads_[std::size_t(q)]) centre += points_.col(corner) / 4;
      middle += centre / double(Valence(v));
    }
    const Eigen::Vector3d at = points_.col(v);
    const double before = LeastSquarenessAbout(v);
    points_.col(v) = projector_.Nearest(at + kShareOfWay * (middle - at));
    if (LeastSquarenessAbout(v) < std::min(before, kFairSquareness)) points_.col(v) = at;
  }
}

int EulerOf(const QuadMesh& mesh) {
  return static_cast<int>(mesh.vertices.cols()) - static_cast<int>(mesh.faces.cols());
}

int EulerOf(const TriangleSurface& surface) {
  return static_cast<int>(surface.vertices.cols() - surface.triangles.cols() / 2);
}

}  // namespace batten::internal
