// SPDX-License-Identifier: MIT
// The alpha shape of points in the plane: the boundary of the region they cover.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "batten/geometry/thread_pool.h"
#include "fitting/neighbours/local_spacing.h"

namespace batten::internal {

// The boundary of the union of all Delaunay triangles of the points (2 × m, finite) but those with
// a circumradius of more than `radius` > 0 for which `is_gap` (corners, circumradius) holds: simple
// closed polygons (2 × k, the last vertex is joined to the first), what is covered on their left,
// so counter-clockwise outside and clockwise round holes; vertices are points of the cloud.
// Polygons may touch in vertices, never cross. Equal up to rounding (2^-31 of the extent) in
// whatever order points come. Only points near empty discs of that radius can matter, so only those
// are triangulated: O(m) and O(b log b) for b points near the border. [Edelsbrunner, Kirkpatrick &
// Seidel 1983]
std::vector<Eigen::Matrix2Xd> AlphaShape(
    const Eigen::Matrix2Xd& points,
    double radius,
    const std::function<bool(const Eigen::Matrix2Xd& corners, double radius)>& is_gap,
    ThreadPool& pool);

// The Delaunay triangles with circumradii of more than `radius`. Cost as above.
std::vector<EmptyCircle> EmptyCircles(const Eigen::Matrix2Xd& points,
                                      double radius,
                                      ThreadPool& pool);

}  // namespace batten::internal
