// SPDX-License-Identifier: MIT
// Surfaces and shells into triangles.
#pragma once

#include <vector>

#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/triangle_mesh.h"

namespace batten {

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

// Meshes of faces that share edges: along them all have the same vertices, so that of a closed
// shell every edge of the mesh lies between two triangles, which run along it in opposite
// directions. `borders` are those of the surfaces, in their order; equal shares of the domains of
// an edge's curves are one point in space but for the gap between its faces. A face with no loops
// has no edges in common. The triangles of each face lie within the chord tolerance of it as
// Tessellate's do, and where `gap` is above a quarter of that by so much more along edges. A knot
// line that ends on an edge needs no vertex there.
//
// How: edges are divided for all their faces together, each face is refined to three quarters of
// the tolerance, and what it splits on an edge the others split too, until none does. Two edges of
// the mesh with the same ends in different faces get vertices of their own. Throws as Tessellate,
// and std::invalid_argument where there is not one border for each surface or a loop is empty.
ShellMesh TessellateShell(const std::vector<NurbsSurface>& surfaces,
                          const std::vector<FaceBorder>& borders,
                          const TessellateOptions& options = {});

}  // namespace batten
