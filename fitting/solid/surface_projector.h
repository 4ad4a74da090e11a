// SPDX-License-Identifier: MIT
// Places on a surface of triangles.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "batten/geometry/triangle_surface.h"

namespace batten::internal {

// The nearest places of a surface of triangles, for vertices that are to stay on it.
class SurfaceProjector {
 public:
  explicit SurfaceProjector(const TriangleSurface& surface);
  ~SurfaceProjector();
  SurfaceProjector(const SurfaceProjector&) = delete;
  SurfaceProjector& operator=(const SurfaceProjector&) = delete;

  // The nearest place on the triangles about the vertices nearest to p.
  Eigen::Vector3d Nearest(const Eigen::Vector3d& p) const;
  // The nearest of those triangles whose normals are less than a right angle from a direction, if
  // any is.
  int TriangleNear(const Eigen::Vector3d& p, const Eigen::Vector3d& direction) const;

 private:
  struct Search;
  const TriangleSurface& surface_;
  std::vector<std::vector<int>> around_;  // triangles of each vertex
  std::unique_ptr<Search> search_;
};

// The nearest place of one triangle.
Eigen::Vector3d NearestOnTriangle(const TriangleSurface& surface, int t, const Eigen::Vector3d& p);

double AreaOf(const TriangleSurface& surface);

}  // namespace batten::internal
