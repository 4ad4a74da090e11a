// SPDX-License-Identifier: MIT
// Triangles over the domain of a surface, with the points of their vertices. Internal to geometry.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/surface_evaluator.h"
#include "geometry/mesh/mesh_domain.h"
#include "geometry/mesh/triangle_error.h"
#include "geometry/numeric/constrained_delaunay.h"

namespace batten::internal {

// A constrained triangulation of the domain, and what of the surface its vertices are.
class DomainMesh {
 public:
  // Everything about `middle`.
  DomainMesh(const NurbsSurface& surface, const Eigen::Vector3d& middle);

  const Eigen::Vector3d& middle() const { return middle_; }
  const SurfaceEvaluator& surface() const { return surface_; }
  const MeshDomain& domain() const { return domain_; }
  const ConstrainedDelaunay& delaunay() const { return delaunay_; }
  ConstrainedDelaunay& delaunay() { return delaunay_; }
  const Eigen::Vector2d& parameter(int vertex) const { return parameters_[vertex]; }
  const Eigen::Vector3d& point(int vertex) const { return points_[vertex]; }  // less the middle
  int size() const { return static_cast<int>(points_.size()); }

  // The nearest place of the domain.
  Eigen::Vector2d Clamped(const Eigen::Vector2d& parameter) const;

  int Insert(const LatticePoint& point);
  // Knows the vertices that the triangulation has got by itself.
  void NoteVertices();
  // Loops keep their own parameters, exactly.
  void MoveVertex(int vertex, const Eigen::Vector2d& parameter);

  // The vertices on the border of the domain, in the order of their lattice points.
  using LatticeKey = std::pair<std::int64_t, std::int64_t>;
  const std::map<LatticeKey, int>& border() const { return border_; }
  // The vertex there, −1: none.
  int BorderVertex(const LatticePoint& point) const;

  SurfaceTriangle SurfaceTriangleOf(const ConstrainedDelaunay::Triangle& triangle) const;

  // Vertices that are one point of the surface get one name: the first of them.
  std::vector<int> Names() const;

 private:
  Eigen::Vector3d middle_;
  SurfaceEvaluator surface_;
  MeshDomain domain_;
  ConstrainedDelaunay delaunay_;
  std::vector<Eigen::Vector2d> parameters_;  // of the vertices
  std::vector<Eigen::Vector3d> points_;
  std::map<LatticeKey, int> border_;
};

}  // namespace batten::internal
