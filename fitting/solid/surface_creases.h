// SPDX-License-Identifier: MIT
// Sharp edges of a surface of triangles.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "batten/geometry/triangle_surface.h"

namespace batten::internal {

class TriangleTopology;

struct SurfaceCreases {
  std::vector<std::array<int, 2>> edges;  // by their ends, the lower one first
  std::vector<char> corner;               // by vertex: curves of creases end, meet or turn there

  bool none() const { return edges.empty(); }
};

// The creases among the half-edges.
std::vector<char> CreasesByHalfEdge(const TriangleTopology& topology,
                                    const SurfaceCreases& creases);

// Edges over which normals turn by much more than beside them, in chains longer than `shortest`.
// Normals are means over triangles beside one another whose own differ by less, so that noise does
// not count: chains hold a part that turns by 35° or more, and go on from there down to 15°.
// [means: Zheng, Fu, Au & Tai 2011; two thresholds: Hubeli & Gross 2001]
SurfaceCreases CreasesOf(const TriangleSurface& surface, double shortest);

// The nearest place on the creases' edges.
Eigen::Vector3d NearestOnCreases(const TriangleSurface& surface,
                                 const SurfaceCreases& creases,
                                 const Eigen::Vector3d& p);

}  // namespace batten::internal
