// SPDX-License-Identifier: MIT
#include "geometry/mesh/triangle_measure.h"

#include <Eigen/Geometry>

namespace batten::internal {

Eigen::Vector3d NormalOf(const TriangleSurface& surface, Eigen::Index t) {
  const auto corner = surface.triangles.col(t);
  const Eigen::Vector3d a = surface.vertices.col(corner[0]);
  return (surface.vertices.col(corner[1]) - a).cross(surface.vertices.col(corner[2]) - a);
}

double AreaOf(const TriangleSurface& surface) {
  double area = 0;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t)
    area += NormalOf(surface, t).norm() / 2;
  return area;
}

}  // namespace batten::internal
