// SPDX-License-Identifier: MIT
// The smallest rectangle, in any direction, that holds points of the plane.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

namespace batten::internal {

// Extents along `axis`, of length 1, and along its left normal.
struct TurnedRectangle {
  double area = std::numeric_limits<double>::infinity();
  Eigen::Vector2d axis = Eigen::Vector2d::UnitX();
  Eigen::Vector2d low = Eigen::Vector2d::Zero(), high = Eigen::Vector2d::Zero();

  Eigen::Vector2d ToFrame(const Eigen::Vector2d& p) const {
    return {p.dot(axis), axis[0] * p[1] - axis[1] * p[0]};
  }
};

// Corners of the convex hull, counter-clockwise from the lowest x; of points on a line its two
// ends. O(m log m). [Andrew 1979]
std::vector<Eigen::Vector2d> ConvexHullOf(std::vector<Eigen::Vector2d> points);

// The one along an axis of length 1, of at least one corner.
TurnedRectangle RectangleAlong(const std::vector<Eigen::Vector2d>& hull,
                               const Eigen::Vector2d& axis);

// The one of least area: a side of it lies along a side of the hull. Of points on a line the area
// is 0. O(k²) of k corners. [Freeman & Shapira 1975]
TurnedRectangle SmallestRectangleAround(const std::vector<Eigen::Vector2d>& hull);

}  // namespace batten::internal
