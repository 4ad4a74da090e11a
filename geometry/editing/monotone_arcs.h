// SPDX-License-Identifier: MIT
// Plane loops cut into arcs along which neither coordinate turns back. Internal to geometry.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// The parameter domain of a surface brought to the unit square.
struct UnitDomain {
  Eigen::Array2d lower, length;

  explicit UnitDomain(const NurbsSurface& surface);
  Eigen::Vector2d operator()(const Eigen::Vector2d& uv) const {
    return (uv.array() - lower) / length;
  }
  Eigen::Vector2d Back(const Eigen::Vector2d& xy) const { return lower + length * xy.array(); }
};

// The part of one loop over its parameters [s0, s1]. Its ends are shared, bit by bit, with the arcs
// before and after it.
struct MonotoneArc {
  int loop;
  double s0, s1;
  Eigen::Vector2d from, to;
  bool rational;
  Eigen::Matrix3Xd net;  // (w·x, w·y, w) in Bézier form over t in [0, 1]

  int degree() const { return static_cast<int>(net.cols()) - 1; }
  double Low(int axis) const { return std::min(from[axis], to[axis]); }
  double High(int axis) const { return std::max(from[axis], to[axis]); }
  double ParameterAt(double t) const { return s0 + t * (s1 - s0); }

  // The point at t; at 0 and 1 exactly the ends.
  Eigen::Vector2d At(double t) const;

  // The place at t and the derivative of y there.
  struct Rise {
    double x, y, slope_y;
  };
  Rise RiseAt(double t) const;

  // On which side of the arc a place of its box lies: −1 on that of small x, 1 on that of great x,
  // 0 where it is within `near` along x or y. The arc lies in two opposite quadrants about each of
  // its points; a place that is in another one is decided.
  int SideOf(const Eigen::Vector2d& place, double near) const;

  // Where a coordinate, 0 for x and 1 for y, has a value; the nearer end where it never has. Exact
  // to rounding of the coordinate. Newton's method inside a bracket, O(p²) a step.
  double Where(int axis, double value) const;
};

// The arcs of loops in order, each loop's one after another, mapped to the unit domain. Cut where
// the derivative of a coordinate changes its sign. The last point of a loop is its first.
std::vector<MonotoneArc> MonotoneArcs(const std::vector<NurbsCurve<2>>& loops,
                                      const UnitDomain& domain);

// Whether any of the arc's points lies in the closed box.
bool Meets(const MonotoneArc& arc, const Eigen::AlignedBox2d& box);

}  // namespace batten::internal
