// SPDX-License-Identifier: MIT
// Places on a surface of triangles.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/neighbours.h"
#include "batten/geometry/triangle_surface.h"

namespace batten::internal {

// The nearest places of a surface of triangles, for vertices that are to stay on it.
class SurfaceProjector {
 public:
  explicit SurfaceProjector(const TriangleSurface& surface);

  // The nearest place on the triangles about the vertices nearest to p.
  Eigen::Vector3d Nearest(const Eigen::Vector3d& p) const;
  // The nearest of those triangles whose normals are less than a right angle from a direction, if
  // any is.
  int TriangleNear(const Eigen::Vector3d& p, const Eigen::Vector3d& direction) const;

 private:
  const TriangleSurface& surface_;
  std::vector<std::vector<int>> around_;  // triangles of each vertex
  NeighbourIndex index_;
};

// The nearest place of one triangle.
Eigen::Vector3d NearestOnTriangle(const TriangleSurface& surface, int t, const Eigen::Vector3d& p);

}  // namespace batten::internal
