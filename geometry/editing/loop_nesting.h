// SPDX-License-Identifier: MIT
// Which plane loops lie in which, judged by polygons.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/nurbs_curve.h"

namespace batten::internal {

// The loop as a fine polygon, a fixed number of vertices a span; the last is joined to the first.
Eigen::Matrix2Xd NestingPolygon(const NurbsCurve<2>& loop);

// The area inside a polygon, positive where it runs counter-clockwise.
double PolygonArea(const Eigen::Matrix2Xd& polygon);

// By the sides crossed on the way to the left; on a side either.
bool InsidePolygon(const Eigen::Matrix2Xd& polygon, const Eigen::Vector2d& place);

// Whether most vertices of a polygon lie in another one: polygons are not exact. Vertices on the
// other's sides say nothing. O(vertices · vertices) where their boxes meet.
bool MostlyInside(const Eigen::Matrix2Xd& polygon, const Eigen::Matrix2Xd& outer);

// For every polygon the smallest larger one that holds it, −1 where there is none.
std::vector<int> EnclosingPolygons(const std::vector<Eigen::Matrix2Xd>& polygons);

}  // namespace batten::internal
