// SPDX-License-Identifier: MIT
// One surface's tessellation under way. Internal to geometry.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/triangle_mesh.h"
#include "batten/geometry/trim_region.h"
#include "geometry/mesh/domain_mesh.h"
#include "geometry/mesh/triangle_proof.h"

namespace batten::internal {

// The surface is first laid out, then refined; what others split is refined again.
class SurfaceTessellation {
 public:
  // Everything about `middle` of the surface's box. Keeps a reference to the options. Throws
  // std::invalid_argument where more than max_triangles are needed.
  SurfaceTessellation(const NurbsSurface& surface,
                      const Eigen::Vector3d& middle,
                      double tolerance,
                      const TessellateOptions& options);

  const DomainMesh& mesh() const { return mesh_; }

  // Lays loops, knots and creases: the surface's own loops or the edges of its domain.
  void Lay();
  // In place of them these loops of places in the domain, each joined to the next; returns their
  // vertices. Where knots meet loops there is no vertex.
  std::vector<std::vector<int>> LayAlong(const std::vector<std::vector<Eigen::Vector2d>>& loops);

  // Splits triangles until all lie within the tolerance, as Tessellate says.
  void Refine();

  // A vertex on the edge between two, where it is nearest to the point along their line; the nearer
  // of the two where there is no room for one.
  int SplitNear(int from, int to, const Eigen::Vector3d& point);
  // Halves the edge between two vertices; whether they are joined and there is room.
  bool Halve(int from, int to);

  // Throws std::invalid_argument for more triangles than are allowed.
  [[noreturn]] void Refuse() const;

 private:
  const SurfaceEvaluator& evaluator() const { return mesh_.surface(); }
  const NurbsSurface& surface() const { return evaluator().surface(); }
  const MeshDomain& domain() const { return mesh_.domain(); }

  void RefuseTooMany() const;
  std::vector<int> LayPlaces(const std::vector<Eigen::Vector2d>& places, std::int64_t onto_border);
  void LayInside(const std::vector<std::vector<int>>& chains);
  void LaySeeds();
  bool Wanted(std::size_t i, std::size_t j);
  void LayCreases();
  void Queue(int triangle);
  void EmptyQueue();
  std::optional<std::array<int, 3>> Unproven(const SurfaceTriangle& triangle);
  bool Split(ConstrainedDelaunay::Place place);
  bool SplitHere(ConstrainedDelaunay::Place place, const LatticePoint& middle);
  bool SplitDoubledEdges();

  DomainMesh mesh_;
  TrimRegion region_;
  TriangleProof proof_;
  double tolerance_;
  const TessellateOptions& options_;
  bool knots_on_border_ = true;
  std::deque<int> queue_;
  std::vector<char> queued_;
};

}  // namespace batten::internal
