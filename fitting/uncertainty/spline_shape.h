// SPDX-License-Identifier: MIT
// A curve or surface as its bases and control points, for what is done alike to both.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

struct SplineShape {
  SplineBasis u;
  std::optional<SplineBasis> v;  // none: a curve
  Eigen::MatrixXd points;        // d × n, v fastest
  Eigen::VectorXd weights;

  explicit SplineShape(const NurbsSurface& surface)
      : u(surface.basis_u()),
        v(surface.basis_v()),
        points(surface.control_points()),
        weights(surface.weights()) {}
  template <int Dim>
  explicit SplineShape(const NurbsCurve<Dim>& curve)
      : u(curve.basis()), points(curve.control_points()), weights(curve.weights()) {}

  int size_v() const { return v ? v->size() : 1; }
};

// Position and unit normal at a place, and the rational functions that act there. Of a plane curve
// the normal is to the left, of a curve in space the side it bends to (any side where it is
// straight); zero where there is none.
struct ShapePlace {
  int span_u = 0, span_v = 0;
  Eigen::VectorXd functions;  // R_ij of the control points first(…) …, j fastest
  Eigen::Vector3d position, normal;

  int count_u = 0, count_v = 0;
  // The index of the control point of function (i, j).
  int Index(int i, int j, int size_v) const {
    return (span_u - count_u + 1 + i) * size_v + span_v - count_v + 1 + j;
  }
};
ShapePlace PlaceOn(const SplineShape& shape, double u, double v);

}  // namespace batten::internal
