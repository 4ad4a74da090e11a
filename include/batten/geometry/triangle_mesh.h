// SPDX-License-Identifier: MIT
// Triangle meshes of surfaces, and what they are made by: options, the borders of faces.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "batten/geometry/nurbs_curve.h"

namespace batten {

// A vertex as some of the triangles around it see it: across a seam it has other parameters, across
// a crease another normal, and at a pole each triangle has its own.
struct OtherSide {
  int vertex;
  Eigen::Vector2d parameter;
  Eigen::Vector3d normal;
};

// A corner (0, 1, 2) of a triangle that belongs to an OtherSide of its vertex.
struct SideCorner {
  int triangle, corner, side;
};

struct TriangleMesh {
  Eigen::Matrix3Xd vertices;
  Eigen::Matrix2Xd parameters;  // of the vertices; on a seam, those of one of its sides
  Eigen::Matrix3Xd normals;     // the surface's unit normals; at tips the mean of the triangles'
  Eigen::Matrix3Xi triangles;   // indices of vertices, counter-clockwise seen against the normals
  // What is not as above: for textures and shading that have to be right at seams and creases.
  std::vector<OtherSide> other_sides = {};
  std::vector<SideCorner> side_corners = {};
};

// The meshes as one, in their order; nothing is joined.
TriangleMesh JoinedMeshes(const std::vector<TriangleMesh>& meshes);

struct TessellateOptions {
  double chord_tolerance = 0;  // ≥ 0, in the data's units; 0: 1e-3 of the surface's diagonal
  Eigen::Index max_triangles = 50000000;  // > 0; what needs more is refused
  // Called from time to time with the share of the triangles so far that are done; what it throws
  // ends the work.
  std::function<void(double)> progress = nullptr;
};

// A piece of the border of a face, in the parameters of its surface.
struct BorderPiece {
  NurbsCurve<2> curve;    // follows the piece before it in its loop
  int edge = -1;          // ≥ 0; the number of the edge that it is, the same on other faces there
  bool reversed = false;  // the curve runs against the edge
};

// All of a face's border, the sides of a domain that is not trimmed, seams and collapsed edges
// included.
struct FaceBorder {
  std::vector<std::vector<BorderPiece>> loops = {};
  bool reversed = false;  // the face's normal is not the surface's
};

struct ShellMesh {
  // Of each face. Normals are the face's, and triangles turn with them.
  std::vector<TriangleMesh> faces;
  // Of each vertex of each face: a number that it has in common with the vertices of other faces
  // that are the same point, from 0 on; −1 inside faces.
  std::vector<std::vector<int>> joints;
  // How far vertices on shared edges are from their surfaces: what faces leave open along them,
  // and up to a quarter of the chord tolerance.
  double gap = 0;
};

}  // namespace batten
