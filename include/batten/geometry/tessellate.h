// SPDX-License-Identifier: MIT
// Triangle meshes of surfaces.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "batten/geometry/nurbs_surface.h"

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

struct TessellateOptions {
  double chord_tolerance = 0;  // ≥ 0, in the data's units; 0: 1e-3 of the surface's diagonal
  Eigen::Index max_triangles = 50000000;  // > 0; what needs more is refused
  // Called from time to time with the share of the triangles so far that are done; what it throws
  // ends the work.
  std::function<void(double)> progress = nullptr;
};

// Triangles that follow the surface, the part inside its trims, within the chord tolerance: the
// triangles' planes lie that near to the surface between their corners, which lie on it, and edges
// on the border that near to the border. Corners of loops are vertices.
// Edges inside the mesh belong to two triangles each, without gaps or vertices in their midst; so
// do the seams of closed surfaces, and a collapsed edge is one vertex. Other edges lie along the
// trim loops or the edges of the domain.
// Every crossing of knot lines inside is a vertex, and lines of knots where the surface may have a
// crease are edges.
//
// How: a constrained Delaunay triangulation over the domain, whose triangles are halved at the edge
// along which the surface bends most, until second derivatives at four places in a triangle, and
// distances there and at the middles of its edges, stay below 0.8 of the tolerance, and the hulls
// of the surface's Bézier points prove that it lies within the tolerance of the triangle's plane
// over all of it, and of the edges that follow a crease or the border (TriangleProof); but where a
// triangle has neither a plane nor the surface a normal, and where none can be halved any more.
// Measured only, at seven places each, are loops against their chords, and whether the surface
// folds back on itself under a triangle. Parameters lie on a lattice of 2^29 steps to the domain,
// loops to half a step; triangles of less than two steps are not halved. The same input gives the
// same mesh. About 4 µs for a triangle of a bicubic surface. Throws std::invalid_argument for
// options out of range and where more than max_triangles are needed, in most cases before work
// begins. [second-derivative bound: Filip, Magedson & Markot 1986; hulls: Lane & Riesenfeld 1980]
TriangleMesh Tessellate(const NurbsSurface& surface, const TessellateOptions& options = {});

// The meshes as one, in their order; nothing is joined.
TriangleMesh JoinedMeshes(const std::vector<TriangleMesh>& meshes);

}  // namespace batten
