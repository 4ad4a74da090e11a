// SPDX-License-Identifier: MIT
// Closed meshes of quadrilaterals: the layouts of smooth solids, and of solids with sharp edges.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace batten {

// Vertices (columns, the data's units) and faces of four vertex indices each, counter-clockwise
// seen from outside. A surface over it is smooth but over the creases, edges named by their ends.
// Three creases or more, or one, end at their vertex; of two it is told whether their curve has a
// corner there.
struct QuadMesh {
  Eigen::Matrix3Xd vertices;
  Eigen::Matrix4Xi faces;
  Eigen::Matrix2Xi creases = Eigen::Matrix2Xi(2, 0);
  std::vector<int> corners = {};  // vertices
  std::vector<int> caps = {};     // faces that only close it, beyond creases: nothing is there
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
// vertex has at least three edges, every component's volume is positive, creases are edges,
// corners vertices and caps faces. O(n).
QuadMeshSummary CheckQuadMesh(const QuadMesh& mesh);

}  // namespace batten
