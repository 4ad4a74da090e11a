// SPDX-License-Identifier: MIT
#include "fitting/solid/creased_mesh.h"

#include <Eigen/Geometry>

namespace batten::internal {

CreasedMesh::CreasedMesh(const TriangleSurface& surface, const SurfaceCreases& creases)
    : around_(std::size_t(surface.vertices.cols())),
      along_(around_.size()),
      corner_(creases.corner) {
  for (const auto p : surface.vertices.colwise()) places_.push_back(p);
  for (const auto t : surface.triangles.colwise()) Add({t[0], t[1], t[2]});
  corner_.resize(around_.size(), 0);
  for (const auto& [a, b] : creases.edges) Join(a, b);
}

Eigen::Vector3d CreasedMesh::NormalOf(const Triangle& t) const {
  return (At(t[1]) - At(t[0])).cross(At(t[2]) - At(t[0]));
}

std::pair<int, int> CreasedMesh::LeftOf(int a, int b) const {
  for (const int t : Around(a)) {
    const Triangle& triangle = TriangleAt(t);
    if (After(triangle, a) == b) return {t, After(triangle, b)};
  }
  return {-1, -1};
}

std::vector<int> CreasedMesh::Neighbours(int v) const {
  std::vector<int> found;
  for (const int t : Around(v)) found.push_back(After(TriangleAt(t), v));
  return found;
}

std::vector<std::pair<int, int>> CreasedMesh::Edges() const {
  std::vector<std::pair<int, int>> edges;
  for (int a = 0; a < int(places_.size()); ++a) {
    for (const int b : Neighbours(a)) {
      if (a < b) edges.emplace_back(a, b);
    }
  }
  return edges;
}

void CreasedMesh::Split(int a, int b) {
  const auto [left, c] = LeftOf(a, b);
  const auto [right, d] = LeftOf(b, a);
  const int m = int(places_.size());
  places_.push_back((At(a) + At(b)) / 2);
  around_.emplace_back();
  along_.emplace_back();
  corner_.push_back(0);
  if (OnCrease(a, b)) {
    Part(a, b);
    Join(a, m);
    Join(m, b);
  }
  Remove(left);
  Remove(right);
  for (const Triangle& t : {Triangle{a, m, c}, {m, b, c}, {b, m, d}, {m, a, d}}) Add(t);
}

void CreasedMesh::Collapse(int a, int b, const Eigen::Vector3d& place) {
  Remove(LeftOf(a, b).first);
  Remove(LeftOf(b, a).first);
  const std::vector<int> moved = Around(a);
  for (const int t : moved) {
    Triangle triangle = TriangleAt(t);
    Remove(t);
    std::replace(triangle.begin(), triangle.end(), a, b);
    Add(triangle);
  }
  places_[std::size_t(b)] = place;
  const std::vector<int> ends = Along(a);
  for (const int end : ends) {
    Part(a, end);
    if (end != b) Join(end, b);
  }
}

void CreasedMesh::Turn(int a, int b) {
  const auto [left, c] = LeftOf(a, b);
  const auto [right, d] = LeftOf(b, a);
  Remove(left);
  Remove(right);
  Add({c, d, b});
  Add({d, c, a});
}

void CreasedMesh::Add(const Triangle& triangle) {
  for (const int v : triangle) around_[std::size_t(v)].push_back(int(triangles_.size()));
  triangles_.push_back(triangle);
}

void CreasedMesh::Remove(int t) {
  for (const int v : TriangleAt(t)) {
    std::vector<int>& fan = around_[std::size_t(v)];
    fan.erase(std::find(fan.begin(), fan.end(), t));
  }
  triangles_[std::size_t(t)] = {-1, -1, -1};
}

void CreasedMesh::Join(int a, int b) {
  along_[std::size_t(a)].push_back(b);
  along_[std::size_t(b)].push_back(a);
}

void CreasedMesh::Part(int a, int b) {
  std::erase(along_[std::size_t(a)], b);
  std::erase(along_[std::size_t(b)], a);
}

CreasedSurface CreasedMesh::Surface() const {
  std::vector<int> number(places_.size(), -1);
  std::vector<Triangle> kept;
  std::vector<Eigen::Vector3d> places;
  for (const Triangle& triangle : triangles_) {
    if (triangle[0] < 0) continue;
    Triangle renamed = triangle;
    for (int& corner : renamed) {
      int& own = number[std::size_t(corner)];
      if (own < 0) {
        own = int(places.size());
        places.push_back(At(corner));
      }
      corner = own;
    }
    kept.push_back(renamed);
  }
  CreasedSurface made;
  made.surface.vertices.resize(3, Eigen::Index(places.size()));
  made.surface.triangles.resize(3, Eigen::Index(kept.size()));
  for (std::size_t k = 0; k < places.size(); ++k)
    made.surface.vertices.col(Eigen::Index(k)) = places[k];
  for (std::size_t k = 0; k < kept.size(); ++k)
    made.surface.triangles.col(Eigen::Index(k)) << kept[k][0], kept[k][1], kept[k][2];
  made.creases.corner.assign(places.size(), 0);
  for (std::size_t a = 0; a < places_.size(); ++a) {
    if (number[a] < 0) continue;
    made.creases.corner[std::size_t(number[a])] = corner_[a];
    for (const int b : along_[a]) {
      const int other = number[std::size_t(b)];
      if (number[a] < other) made.creases.edges.push_back({number[a], other});
    }
  }
  return made;
}

}  // namespace batten::internal
