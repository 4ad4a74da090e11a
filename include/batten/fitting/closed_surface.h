// SPDX-License-Identifier: MIT
// Faces of a file as a closed surface of triangles.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/triangle_surface.h"

namespace batten {

// Faces as they are: nothing is closed, turned or parted.
struct FaceSurface {
  TriangleSurface surface;
  int joined = 0;         // vertices at the place of another, or at open edges nearly so
  int dropped = 0;        // faces without area, or there twice
  int open_edges = 0;     // of one triangle
  int crowded_edges = 0;  // of more than two
};

// Joins vertices at one place, and those of open edges within the digits of a file, cuts faces into
// triangles and drops those without area or twice there. O(n). Throws RefusedData where no
// face is left.
FaceSurface SurfaceOfFaces(const Eigen::Matrix3Xd& vertices,
                           const std::vector<std::vector<int>>& faces);

// A closed surface made of faces that were not quite one, and what was done to them.
struct ClosedSurface {
  TriangleSurface surface;
  int joined = 0;           // vertices at the place of another, or at open edges nearly so
  int dropped = 0;          // faces without area, or there twice
  int turned = 0;           // faces turned round
  int filled = 0;           // holes closed
  double filled_share = 0;  // of the area
  int components = 0, genus = 0;
};

// Turns faces alike and outwards, parts surfaces that touch at a vertex or an edge only, and closes
// holes by triangles about their middles. O(n). Throws RefusedData, naming it, where more than two
// faces meet at an edge other than as bodies that touch there, a surface has one side only, no face
// is left, holes are more than `most_filled` of the area, or one of two bodies lies in the other or
// runs through it.
ClosedSurface CloseSurface(const FaceSurface& faces, double most_filled = 0.15);
ClosedSurface CloseSurface(const Eigen::Matrix3Xd& vertices,
                           const std::vector<std::vector<int>>& faces,
                           double most_filled = 0.15);

// Unit normals at points: those of the surface, from the triangles about it, at the vertex nearest
// to each.
Eigen::Matrix3Xd NormalsNear(const TriangleSurface& surface, const Eigen::Matrix3Xd& points);

}  // namespace batten
