// SPDX-License-Identifier: MIT
// Exact constraints on a surface: edge curves, tangent fields, points and normals.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "batten/geometry/joins.h"
#include "batten/geometry/nurbs_curve.h"

namespace batten::internal {

// An edge of the surface given as a curve: S(u, lower) = curve(u), and so on. Along it the surface
// may also have to be tangent to a neighbour.
struct FixedEdge {
  SurfaceEdge edge;  // where `direction` is at the end of its domain
  // Over the domain of the basis along the edge, in the direction of its parameter; no weights,
  // degree at most the basis'; any knots.
  NurbsCurve<3> curve;
  // A spline vector field T over the same domain that spans the tangent planes with the curve's own
  // derivative E: the surface's derivative across the edge, in the direction of the rising
  // parameter, is a·T + b·E, b any and a > 0. The derivative across a neighbour's edge is one.
  std::optional<NurbsCurve<3>> across = std::nullopt;
};

// A point constraint: at (u, v) the surface has this place, or this normal (either sign), or both.
struct FixedPoint {
  double u = 0, v = 0;
  std::optional<Eigen::Vector3d> place = std::nullopt;
  std::optional<Eigen::Vector3d> normal = std::nullopt;  // of any length but zero
};

struct SurfaceConstraints {
  std::vector<FixedEdge> edges;  // at most one each
  std::vector<FixedPoint> points;
};

// A constraint that contradicts earlier ones, and the amount by which the surface misses it.
struct MissedConstraint {
  std::string condition;  // which
  double amount = 0;      // the data's units; an angle in radians
  bool angle = false;

  std::string Text() const;  // "…: missed by …"
};

}  // namespace batten::internal
