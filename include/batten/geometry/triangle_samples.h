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

// How far a smooth body is from the middles of the triangles whose corners are on it: by the angles
// at their edges, where these are less than `crease` (radians), the height that 95 % of the area
// keeps below. 0 where there are no such edges. O(n)
double ChordHeight(const TriangleSurface& surface, double crease);

// The share of sharp edges, those that turn by more than `crease` (radians), in the length of all
// edges. O(n)
double SharpShare(const TriangleSurface& surface, double crease);

// The area of the triangles.
double AreaOf(const TriangleSurface& surface);

}  // namespace batten
