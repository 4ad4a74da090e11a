// SPDX-License-Identifier: MIT
// Closed meshes of quadrilaterals: the layouts of smooth solids.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace batten {

// Vertices (columns, the data's units) and faces of four vertex indices each, counter-clockwise
// seen from outside.
struct QuadMesh {
  Eigen::Matrix3Xd vertices;
  Eigen::Matrix4Xi faces;
};

// What a closed mesh of quadrilaterals is like, as a surface.
struct QuadMeshSummary {
  int components = 0;
  int genus = 0;          // summed over the components
  int extraordinary = 0;  // vertices that do not have four edges
  int least_valence = 0, greatest_valence = 0;
  double volume = 0;  // of the polyhedron with faces cut into four at their middles; signed
};

// Throws std::invalid_argument, with a sentence for the user that names the vertex, edge or face,
// unless every face has four different vertices that exist and are finite, every edge belongs to
// two faces that run along it in opposite directions, the faces at every vertex form one fan, every
// vertex has at least three edges, and every component's volume is positive. O(n).
QuadMeshSummary CheckQuadMesh(const QuadMesh& mesh);

}  // namespace batten
