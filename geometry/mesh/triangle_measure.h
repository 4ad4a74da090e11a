// SPDX-License-Identifier: MIT
// Normals and areas of triangles.
#pragma once

#include "batten/geometry/triangle_surface.h"

namespace batten::internal {

// Normal to a triangle, twice as long as its area is large.
Eigen::Vector3d NormalOf(const TriangleSurface& surface, Eigen::Index t);

double AreaOf(const TriangleSurface& surface);

}  // namespace batten::internal
