// SPDX-License-Identifier: MIT
#include "fitting/solid/even_triangles.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>
#include <vector>

namespace batten::internal {
namespace {

void SplitLonger(double length, CreasedMesh& mesh) {
  for (bool more = true; more;) {
    more = false;
    for (const auto& [a, b] : mesh.Edges()) {
      if ((mesh.At(a) - mesh.At(b)).norm() <= length) continue;
      if (mesh.LeftOf(a, b).first < 0 || mesh.LeftOf(b, a).first < 0) continue;
      mesh.Split(a, b);
      more = true;
    }
  }
}

// Whether the triangles stay a surface without the edge: what both its ends are next to is the
// corners of its two triangles alone, each with edges to spare. A vertex of a crease goes along
// that, if it stays three edges long where it closes.
bool MayGo(int a, int b, const CreasedMesh& mesh) {
  if (mesh.Held(a) == 2 || (mesh.Held(a) == 1 && !mesh.OnCrease(a, b))) return false;
  for (const int v : mesh.Along(a)) {
    if (v != b && mesh.OnCrease(v, b)) return false;
  }
  const auto [left, c] = mesh.LeftOf(a, b);
  const auto [right, d] = mesh.LeftOf(b, a);
  if (left < 0 || right < 0) return false;
  const std::vector<int> of_a = mesh.Neighbours(a), of_b = mesh.Neighbours(b);
  const auto common = std::count_if(of_a.begin(), of_a.end(), [&](int v) {
    return std::find(of_b.begin(), of_b.end(), v) != of_b.end();
  });
  return common == 2 && mesh.Around(c).size() >= 4 && mesh.Around(d).size() >= 4 &&
         of_a.size() + of_b.size() >= 7;
}

// Whether the triangles about one end, but those at the other, hardly turn and get no edge above
// `longest` when it moves.
bool MayMove(
    int end, int other, const Eigen::Vector3d& place, double longest, const CreasedMesh& mesh) {
  constexpr double kTurn = 0.3;  // cosine
  for (const int t : mesh.Around(end)) {
    const CreasedMesh::Triangle& triangle = mesh.TriangleAt(t);
    const int p = CreasedMesh::After(triangle, end), q = CreasedMesh::After(triangle, p);
    if (p == other || q == other) continue;
    const Eigen::Vector3d before = mesh.NormalOf(triangle);
    const Eigen::Vector3d after = (mesh.At(p) - place).cross(mesh.At(q) - place);
    if (after.dot(before) < kTurn * after.norm() * before.norm()) return false;
    if ((mesh.At(p) - place).norm() > longest) return false;
  }
  return true;
}

void CollapseShorter(double length,
                     double longest,
                     const TriangleSurface& surface,
                     const SurfaceCreases& creases,
                     CreasedMesh& mesh) {
  for (auto [a, b] : mesh.Edges()) {
    if (mesh.Around(a).empty() || mesh.Around(b).empty() ||
        !((mesh.At(a) - mesh.At(b)).norm() < length)) {
      continue;
    }
    if (mesh.Held(a) > mesh.Held(b)) std::swap(a, b);
    if (!MayGo(a, b, mesh)) continue;
    Eigen::Vector3d place = (mesh.At(a) + mesh.At(b)) / 2;
    if (mesh.Held(a) < mesh.Held(b)) {
      place = mesh.At(b);
    } else if (mesh.Held(a) == 1) {
      place = NearestOnCreases(surface, creases, place);
    }
    if (MayMove(a, b, place, longest, mesh) && MayMove(b, a, place, longest, mesh))
      mesh.Collapse(a, b, place);
  }
}

// Whether vertices come nearer to six edges each when the edge crosses over.
bool EvensOut(int a, int b, int c, int d, const CreasedMesh& mesh) {
  const auto off = [&](int v, int change) {
    return std::abs(int(mesh.Around(v).size()) + change - 6);
  };
  const int before = off(a, 0) + off(b, 0) + off(c, 0) + off(d, 0);
  const int after = off(a, -1) + off(b, -1) + off(c, 1) + off(d, 1);
  return after < before;
}

void TurnEdges(CreasedMesh& mesh) {
  constexpr double kTurn = 0.8;  // of twice the cosine
  for (const auto& [a, b] : mesh.Edges()) {
    const auto [left, c] = mesh.LeftOf(a, b);
    const auto [right, d] = mesh.LeftOf(b, a);
    if (left < 0 || right < 0 || c == d || mesh.OnCrease(a, b)) continue;
    if (mesh.Around(a).size() < 4 || mesh.Around(b).size() < 4) continue;
    if (!EvensOut(a, b, c, d, mesh)) continue;
    if (mesh.LeftOf(c, d).first >= 0 || mesh.LeftOf(d, c).first >= 0) continue;
    const auto normal_of = [&](const CreasedMesh::Triangle& t) {
      return mesh.NormalOf(t).stableNormalized();
    };
    const Eigen::Vector3d normal =
        normal_of(mesh.TriangleAt(left)) + normal_of(mesh.TriangleAt(right));
    if (normal_of({c, d, b}).dot(normal) < kTurn || normal_of({d, c, a}).dot(normal) < kTurn)
      continue;
    mesh.Turn(a, b);
  }
}

void Relax(double length,
           const TriangleSurface& surface,
           const SurfaceCreases& creases,
           const SurfaceProjector& projector,
           CreasedMesh& mesh) {
  constexpr double kShare = 0.7;
  std::vector<Eigen::Vector3d> moved = mesh.places();
  for (int v = 0; v < int(moved.size()); ++v) {
    if (mesh.Around(v).empty() || mesh.Held(v) == 2) continue;
    const Eigen::Vector3d& at = mesh.At(v);
    if (mesh.Held(v) == 1) {
      const std::vector<int>& along = mesh.Along(v);
      const Eigen::Vector3d middle = (mesh.At(along[0]) + mesh.At(along[1])) / 2;
      moved[std::size_t(v)] = NearestOnCreases(surface, creases, at + kShare * (middle - at));
      continue;
    }
    Eigen::Vector3d normal = Eigen::Vector3d::Zero(), middle = normal;
    for (const int t : mesh.Around(v)) normal += mesh.NormalOf(mesh.TriangleAt(t));
    normal.stableNormalize();
    const std::vector<int> beside = mesh.Neighbours(v);
    for (const int other : beside) middle += mesh.At(other) / double(beside.size());
    Eigen::Vector3d way = middle - at;
    way -= way.dot(normal) * normal;
    const Eigen::Vector3d place = projector.Nearest(at + kShare * way);
    if ((place - at).norm() < length) moved[std::size_t(v)] = place;
  }
  mesh.MoveTo(std::move(moved));
}

}  // namespace

CreasedSurface EvenTriangles(const TriangleSurface& surface,
                             const SurfaceCreases& creases,
                             const SurfaceProjector& projector,
                             double length,
                             const Progress& progress) {
  constexpr int kRounds = 10;
  constexpr double kLong = 4.0 / 3, kShort = 4.0 / 5;  // [Botsch & Kobbelt 2004]
  CreasedMesh mesh(surface, creases);
  for (int round = 0; round < kRounds; ++round) {
    Report(progress, "layout", 0.5 * round / kRounds);
    SplitLonger(kLong * length, mesh);
    CollapseShorter(kShort * length, kLong * length, surface, creases, mesh);
    TurnEdges(mesh);
    Relax(length, surface, creases, projector, mesh);
  }
  return mesh.Surface();
}

}  // namespace batten::internal
