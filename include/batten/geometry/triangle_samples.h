// SPDX-License-Identifier: MIT
// Points that stand for a mesh of triangles.
#pragma once

#include <Eigen/Core>

#include "batten/geometry/triangle_surface.h"

namespace batten {

// Points on a surface and, of each, the unit normal and the triangle.
struct TriangleSamples {
  Eigen::Matrix3Xd points, normals;
  Eigen::VectorXi triangles;
};

// Points spread evenly over the triangles, one for each square of side `spacing` that they have
// more than their corners stand for (half a point a triangle): many on large triangles, none where
// the vertices are denser. The same for the same surface. O(n + m) for n triangles and m points.
// Precondition: spacing > 0.
TriangleSamples SampleTriangles(const TriangleSurface& surface, double spacing);

// The spacing at which about `points` points, the corners included, stand for the surface.
double SampleSpacing(const TriangleSurface& surface, Eigen::Index points);

// How far a body that is smooth there is from the middles of triangles whose corners are on it: by
// the angles at their edges, where these are less than 25 degrees (polygons of more than 14 sides
// are round), the height that 95 % of their area keeps below. 0 where there are no such edges. O(n)
double ChordHeight(const TriangleSurface& surface);

// The share of the area that the vertices do not stand for: that of triangles with an edge longer
// than three times the mean spacing of the vertices. Next to nothing on scans, most of what CAD
// programs write. O(n)
double SparseShare(const TriangleSurface& surface);

}  // namespace batten
