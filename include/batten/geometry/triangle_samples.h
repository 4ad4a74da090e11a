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

// The standard deviation of places on the triangles from such a body: ChordHeight / 3.35, for
// places on a chord are 4 t (1 - t) of its height from the arc.
double ChordDeviation(const TriangleSurface& surface);

// Whether the vertices do not stand for the surface: triangles with an edge longer than three times
// their mean spacing are more than a third of its area. Less than a quarter is so of scans, more
// than two fifths of what CAD programs write. O(n)
bool IsSparse(const TriangleSurface& surface);

// Whether most of its area is of triangles in one plane with one beside them, as those of flat and
// ruled faces that CAD programs write. O(n)
bool IsMostlyFlat(const TriangleSurface& surface);

// The points that stand for the surface beside its vertices: as many as let a face of a hundredth
// of its area have two hundred, or as the vertices are; on each smooth patch, which edges of more
// than 25 degrees border, at least a hundred and fifty while patches are few.
TriangleSamples SamplesBesideVertices(const TriangleSurface& surface);

// The middles of the triangles that have none of the samples.
TriangleSamples MiddlesWithout(const TriangleSurface& surface, const TriangleSamples& samples);

}  // namespace batten
