// SPDX-License-Identifier: MIT
#include "geometry/mesh/domain_mesh.h"

#include <algorithm>

namespace batten::internal {

DomainMesh::DomainMesh(const NurbsSurface& surface, const Eigen::Vector3d& middle)
    : middle_(middle), surface_(surface.Translated(-middle)), domain_(surface_.surface()) {}

Eigen::Vector2d DomainMesh::Clamped(const Eigen::Vector2d& parameter) const {
  const SplineBasis &u = surface_.surface().basis_u(), &v = surface_.surface().basis_v();
  return {std::clamp(parameter[0], u.lower(), u.upper()),
          std::clamp(parameter[1], v.lower(), v.upper())};
}

int DomainMesh::Insert(const LatticePoint& point) {
  const int vertex = delaunay_.Insert(point);
  NoteVertices();
  return vertex;
}

void DomainMesh::NoteVertices() {
  constexpr int kCorners = 4;
  const NurbsSurface& surface = surface_.surface();
  for (int k = size(); k < static_cast<int>(delaunay_.points().size()); ++k) {
    const LatticePoint& place = delaunay_.points()[k];
    parameters_.push_back(
        k < kCorners ? Eigen::Vector2d(surface.basis_u().lower(), surface.basis_v().lower())
                     : domain_.ParameterOf(place));
    points_.push_back(surface_.At(parameters_[k][0], parameters_[k][1]));
    if (k >= kCorners && domain_.OnBorder(place)) border_[{place.x, place.y}] = k;
  }
}

void DomainMesh::MoveVertex(int vertex, const Eigen::Vector2d& parameter) {
  parameters_[vertex] = parameter;
  points_[vertex] = surface_.At(parameter[0], parameter[1]);
}

int DomainMesh::BorderVertex(const LatticePoint& point) const {
  const auto found = border_.find({point.x, point.y});
  return found == border_.end() ? -1 : found->second;
}

SurfaceTriangle DomainMesh::SurfaceTriangleOf(const ConstrainedDelaunay::Triangle& triangle) const {
  SurfaceTriangle result;
  for (int e = 0; e < 3; ++e) {
    const int vertex = triangle.vertices[e];
    result.parameters[e] = parameters_[vertex];
    result.points[e] = points_[vertex];
    const LatticePoint& a = delaunay_.points()[triangle.vertices[(e + 1) % 3]];
    const LatticePoint& b = delaunay_.points()[triangle.vertices[(e + 2) % 3]];
    const bool seam = (domain_.closed_u() && a.x == b.x && (a.x == 0 || a.x == domain_.width())) ||
                      (domain_.closed_v() && a.y == b.y && (a.y == 0 || a.y == domain_.height()));
    result.lines[e] = (triangle.fixed >> e & 1) && !seam;
  }
  return result;
}

std::vector<int> DomainMesh::Names() const {
  std::vector<int> names(points_.size());
  for (std::size_t k = 0; k < names.size(); ++k) names[k] = static_cast<int>(k);
  std::map<LatticeKey, int> first;
  for (const auto& [key, vertex] : border_) {
    const LatticePoint canonical = domain_.Canonical({key.first, key.second});
    names[vertex] = first.emplace(LatticeKey{canonical.x, canonical.y}, vertex).first->second;
  }
  return names;
}

}  // namespace batten::internal
