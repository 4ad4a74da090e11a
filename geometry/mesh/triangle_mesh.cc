// SPDX-License-Identifier: MIT
#include "batten/geometry/triangle_mesh.h"

namespace batten {

TriangleMesh JoinedMeshes(const std::vector<TriangleMesh>& meshes) {
  Eigen::Index vertices = 0, triangles = 0;
  for (const TriangleMesh& mesh : meshes) {
    vertices += mesh.vertices.cols();
    triangles += mesh.triangles.cols();
  }
  TriangleMesh all;
  all.vertices.resize(3, vertices);
  all.parameters.resize(2, vertices);
  all.normals.resize(3, vertices);
  all.triangles.resize(3, triangles);
  Eigen::Index vertex = 0, triangle = 0;
  for (const TriangleMesh& mesh : meshes) {
    all.vertices.middleCols(vertex, mesh.vertices.cols()) = mesh.vertices;
    all.parameters.middleCols(vertex, mesh.vertices.cols()) = mesh.parameters;
    all.normals.middleCols(vertex, mesh.vertices.cols()) = mesh.normals;
    all.triangles.middleCols(triangle, mesh.triangles.cols()) =
        mesh.triangles.array() + static_cast<int>(vertex);
    const int side = static_cast<int>(all.other_sides.size());
    for (OtherSide other : mesh.other_sides) {
      other.vertex += static_cast<int>(vertex);
      all.other_sides.push_back(other);
    }
    for (SideCorner corner : mesh.side_corners) {
      corner.triangle += static_cast<int>(triangle);
      corner.side += side;
      all.side_corners.push_back(corner);
    }
    vertex += mesh.vertices.cols();
    triangle += mesh.triangles.cols();
  }
  return all;
}

}  // namespace batten
