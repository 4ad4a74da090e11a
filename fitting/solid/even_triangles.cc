// SPDX-License-Identifier: MIT
#include "fitting/solid/even_triangles.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace batten::internal {
namespace {

using Triangle = std::array<int, 3>;

class EvenMesh {
 public:
  EvenMesh(const TriangleSurface& surface,
           const SurfaceCreases& creases,
           const SurfaceProjector& projector,
           double length)
      : surface_(surface),
        creases_(creases),
        projector_(projector),
        length_(length),
        around_(std::size_t(surface.vertices.cols())),
        along_(around_.size()),
        corner_(creases.corner) {
    for (const auto p : surface.vertices.colwise()) points_.push_back(p);
    for (const auto t : surface.triangles.colwise()) AddTriangle({t[0], t[1], t[2]});
    corner_.resize(around_.size(), 0);
    for (const auto& [a, b] : creases.edges) Join(a, b);
  }

  // A round of all four operations.
  void Improve() {
    constexpr double kLong = 4.0 / 3, kShort = 4.0 / 5;  // [Botsch & Kobbelt 2004]
    SplitLonger(kLong * length_);
    CollapseShorter(kShort * length_, kLong * length_);
    Turn();
    Relax();
  }

  EvenSurface Surface() const {
    std::vector<int> number(points_.size(), -1);
    EvenSurface even;
    TriangleSurface& surface = even.surface;
    std::vector<Triangle> kept;
    std::vector<Eigen::Vector3d> places;
    for (const Triangle& triangle : triangles_) {
      if (triangle[0] < 0) continue;
      Triangle renamed{};
      for (int k = 0; k < 3; ++k) {
        int& own = number[std::size_t(triangle[std::size_t(k)])];
        if (own < 0) {
          own = int(places.size());
          places.push_back(points_[std::size_t(triangle[std::size_t(k)])]);
        }
        renamed[std::size_t(k)] = own;
      }
      kept.push_back(renamed);
    }
    surface.vertices.resize(3, Eigen::Index(places.size()));
    surface.triangles.resize(3, Eigen::Index(kept.size()));
    for (std::size_t k = 0; k < places.size(); ++k)
      surface.vertices.col(Eigen::Index(k)) = places[k];
    for (std::size_t k = 0; k < kept.size(); ++k) {
      surface.triangles.col(Eigen::Index(k)) << kept[k][0], kept[k][1], kept[k][2];
    }
    even.creases.corner.assign(places.size(), 0);
    for (std::size_t a = 0; a < points_.size(); ++a) {
      if (number[a] < 0) continue;
      even.creases.corner[std::size_t(number[a])] = corner_[a];
      for (const int b : along_[a]) {
        const int other = number[std::size_t(b)];
        if (number[a] < other) even.creases.edges.push_back({number[a], other});
      }
    }
    return even;
  }

 private:
  Eigen::Vector3d& At(int v) { return points_[std::size_t(v)]; }
  const Eigen::Vector3d& At(int v) const { return points_[std::size_t(v)]; }

  void AddTriangle(const Triangle& triangle) {
    for (const int v : triangle) around_[std::size_t(v)].push_back(int(triangles_.size()));
    triangles_.push_back(triangle);
  }

  void RemoveTriangle(int t) {
    for (const int v : triangles_[std::size_t(t)]) {
      std::vector<int>& fan = around_[std::size_t(v)];
      fan.erase(std::find(fan.begin(), fan.end(), t));
    }
    triangles_[std::size_t(t)] = {-1, -1, -1};
  }

  Eigen::Vector3d NormalOf(const Triangle& t) const {
    return (At(t[1]) - At(t[0])).cross(At(t[2]) - At(t[0]));
  }

  static int After(const Triangle& t, int v) { return v == t[0] ? t[1] : v == t[1] ? t[2] : t[0]; }

  // The triangle to the left of the edge from a to b, and its third corner; −1: none.
  std::pair<int, int> LeftOf(int a, int b) const {
    for (const int t : around_[std::size_t(a)]) {
      const Triangle& triangle = triangles_[std::size_t(t)];
      if (After(triangle, a) == b) return {t, After(triangle, b)};
    }
    return {-1, -1};
  }

  std::vector<int> Neighbours(int v) const {
    std::vector<int> found;
    for (const int t : around_[std::size_t(v)])
      found.push_back(After(triangles_[std::size_t(t)], v));
    return found;
  }

  std::vector<std::pair<int, int>> Edges() const {
    std::vector<std::pair<int, int>> edges;
    for (int a = 0; a < int(points_.size()); ++a) {
      for (const int b : Neighbours(a)) {
        if (a < b) edges.emplace_back(a, b);
      }
    }
    return edges;
  }

  void Join(int a, int b) {
    along_[std::size_t(a)].push_back(b);
    along_[std::size_t(b)].push_back(a);
  }
  bool OnCrease(int a, int b) const {
    const std::vector<int>& along = along_[std::size_t(a)];
    return std::find(along.begin(), along.end(), b) != along.end();
  }
  void Part(int a, int b) {
    std::erase(along_[std::size_t(a)], b);
    std::erase(along_[std::size_t(b)], a);
  }
  // How much keeps a vertex where it is: nothing, a crease, a corner.
  int Held(int v) const {
    return corner_[std::size_t(v)] ? 2 : along_[std::size_t(v)].empty() ? 0 : 1;
  }

  void SplitLonger(double length) {
    for (bool more = true; more;) {
      more = false;
      for (const auto& [a, b] : Edges()) {
        if ((At(a) - At(b)).norm() <= length) continue;
        const auto [left, c] = LeftOf(a, b);
        const auto [right, d] = LeftOf(b, a);
        if (left < 0 || right < 0) continue;
        const int m = int(points_.size());
        points_.push_back((At(a) + At(b)) / 2);
        around_.emplace_back();
        along_.emplace_back();
        corner_.push_back(0);
        if (OnCrease(a, b)) {
          Part(a, b);
          Join(a, m);
          Join(m, b);
        }
        RemoveTriangle(left);
        RemoveTriangle(right);
        for (const Triangle& t : {Triangle{a, m, c}, {m, b, c}, {b, m, d}, {m, a, d}})
          AddTriangle(t);
        more = true;
      }
    }
  }

  void CollapseShorter(double length, double longest) {
    for (const auto& [a, b] : Edges()) {
      if (!around_[std::size_t(a)].empty() && !around_[std::size_t(b)].empty() &&
          (At(a) - At(b)).norm() < length) {
        Collapse(a, b, longest);
      }
    }
  }

  void Collapse(int a, int b, double longest) {
    if (Held(a) > Held(b)) std::swap(a, b);
    // A vertex of a crease goes along it, if that stays three edges long where it closes.
    if (Held(a) == 2 || (Held(a) == 1 && !OnCrease(a, b))) return;
    int before = -1;
    for (const int v : along_[std::size_t(a)]) before = v == b ? before : v;
    if (before >= 0 && OnCrease(before, b)) return;
    const auto [left, c] = LeftOf(a, b);
    const auto [right, d] = LeftOf(b, a);
    if (left < 0 || right < 0) return;
    // What a and b are both next to is the two triangles' corners alone, each with edges to spare.
    const std::vector<int> of_a = Neighbours(a), of_b = Neighbours(b);
    int common = 0;
    for (const int v : of_a) common += std::find(of_b.begin(), of_b.end(), v) != of_b.end();
    if (common != 2 || around_[std::size_t(c)].size() < 4 || around_[std::size_t(d)].size() < 4)
      return;
    if (of_a.size() + of_b.size() < 7) return;
    Eigen::Vector3d middle = (At(a) + At(b)) / 2;
    if (Held(a) < Held(b)) {
      middle = At(b);
    } else if (Held(a) == 1) {
      middle = NearestOnCreases(surface_, creases_, middle);
    }
    for (const int end : {a, b}) {
      for (const int t : around_[std::size_t(end)]) {
        if (t == left || t == right) continue;
        const Triangle& triangle = triangles_[std::size_t(t)];
        const int p = After(triangle, end), q = After(triangle, p);
        const Eigen::Vector3d after = (At(p) - middle).cross(At(q) - middle);
        constexpr double kTurn = 0.3;  // cosine
        if (after.dot(NormalOf(triangle)) < kTurn * after.norm() * NormalOf(triangle).norm())
          return;
        if ((At(p) - middle).norm() > longest) return;
      }
    }
    RemoveTriangle(left);
    RemoveTriangle(right);
    const std::vector<int> moved = around_[std::size_t(a)];
    for (const int t : moved) {
      Triangle triangle = triangles_[std::size_t(t)];
      RemoveTriangle(t);
      std::replace(triangle.begin(), triangle.end(), a, b);
      AddTriangle(triangle);
    }
    At(b) = middle;
    if (before < 0) return;
    Part(a, b);
    Part(before, a);
    Join(before, b);
  }

  void Turn() {
    const auto off = [](std::size_t edges, int change) {
      return std::abs(int(edges) + change - 6);
    };
    for (const auto& [a, b] : Edges()) {
      const auto [left, c] = LeftOf(a, b);
      const auto [right, d] = LeftOf(b, a);
      if (left < 0 || right < 0 || c == d || OnCrease(a, b)) continue;
      const std::size_t na = around_[std::size_t(a)].size(), nb = around_[std::size_t(b)].size();
      const std::size_t nc = around_[std::size_t(c)].size(), nd = around_[std::size_t(d)].size();
      if (na < 4 || nb < 4) continue;
      const int before = off(na, 0) + off(nb, 0) + off(nc, 0) + off(nd, 0);
      const int after = off(na, -1) + off(nb, -1) + off(nc, 1) + off(nd, 1);
      if (after >= before || LeftOf(c, d).first >= 0 || LeftOf(d, c).first >= 0) continue;
      const Triangle one = {c, d, b}, two = {d, c, a};
      const Eigen::Vector3d normal = NormalOf(triangles_[std::size_t(left)]).stableNormalized() +
                                     NormalOf(triangles_[std::size_t(right)]).stableNormalized();
      constexpr double kTurn = 0.8;  // of twice the cosine
      if (NormalOf(one).stableNormalized().dot(normal) < kTurn ||
          NormalOf(two).stableNormalized().dot(normal) < kTurn) {
        continue;
      }
      RemoveTriangle(left);
      RemoveTriangle(right);
      AddTriangle(one);
      AddTriangle(two);
    }
  }

  void Relax() {
    std::vector<Eigen::Vector3d> moved = points_;
    for (int v = 0; v < int(points_.size()); ++v) {
      if (around_[std::size_t(v)].empty() || Held(v) == 2) continue;
      constexpr double kShare = 0.7;
      if (Held(v) == 1) {
        const std::vector<int>& along = along_[std::size_t(v)];
        const Eigen::Vector3d middle = (At(along[0]) + At(along[1])) / 2;
        moved[std::size_t(v)] =
            NearestOnCreases(surface_, creases_, At(v) + kShare * (middle - At(v)));
        continue;
      }
      Eigen::Vector3d normal = Eigen::Vector3d::Zero(), middle = normal;
      for (const int t : around_[std::size_t(v)]) normal += NormalOf(triangles_[std::size_t(t)]);
      normal.stableNormalize();
      const std::vector<int> beside = Neighbours(v);
      for (const int other : beside) middle += At(other) / double(beside.size());
      Eigen::Vector3d way = middle - At(v);
      way -= way.dot(normal) * normal;
      const Eigen::Vector3d place = projector_.Nearest(At(v) + kShare * way);
      if ((place - At(v)).norm() < length_) moved[std::size_t(v)] = place;
    }
    points_ = std::move(moved);
  }

  const TriangleSurface& surface_;
  const SurfaceCreases& creases_;
  const SurfaceProjector& projector_;
  double length_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<Triangle> triangles_;
  std::vector<std::vector<int>> around_, along_;  // triangles; the other ends of crease edges
  std::vector<char> corner_;
};

}  // namespace

EvenSurface EvenTriangles(const TriangleSurface& surface,
                          const SurfaceCreases& creases,
                          const SurfaceProjector& projector,
                          double length,
                          const Progress& progress) {
  constexpr int kRounds = 10;
  EvenMesh mesh(surface, creases, projector, length);
  for (int round = 0; round < kRounds; ++round) {
    Report(progress, "layout", 0.5 * round / kRounds);
    mesh.Improve();
  }
  return mesh.Surface();
}

}  // namespace batten::internal
