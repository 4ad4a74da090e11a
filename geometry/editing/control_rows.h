// SPDX-License-Identifier: MIT
// A curve, or a surface seen along one direction: the form in which knots are edited.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/direction.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// m rows of n control points each over one basis of n functions: a curve is one row, a surface seen
// along u has a row for every index of v and the other way round. Points stay Euclidean and weights
// apart, so that what an edit does not change stays the same bit by bit, and coincident control
// points stay coincident.
struct ControlRows {
  SplineBasis basis;
  std::vector<Eigen::MatrixXd> coordinates;  // Dim matrices, m × n
  Eigen::MatrixXd weights;                   // m × n; empty where the shape is not rational
  double common_weight = 1;                  // of every control point where `weights` is empty

  bool rational() const { return weights.size() > 0; }
  Eigen::Index rows() const { return coordinates.front().rows(); }
  int dimension() const { return static_cast<int>(coordinates.size()); }

  // One homogeneous control point: Euclidean place (z = 0 in the plane) and weight, one where the
  // shape is not rational.
  struct Point {
    Eigen::Vector3d place = Eigen::Vector3d::Zero();
    double weight = 1;
  };
  Point At(Eigen::Index row, Eigen::Index i) const;
  void Set(Eigen::Index row, Eigen::Index i, const Point& point);
};

// Rows of the same kind as `like` over another basis, all values zero.
ControlRows EmptyRows(const ControlRows& like, SplineBasis basis);

// Columns first … first + basis.size() − 1 of the rows, over `basis`.
ControlRows ColumnsOf(const ControlRows& rows, Eigen::Index first, SplineBasis basis);

// The rows run through the other way, over the mirrored knots.
ControlRows ReversedRows(ControlRows rows);

template <int Dim>
ControlRows RowsOf(const NurbsCurve<Dim>& curve);
ControlRows RowsOf(const NurbsSurface& surface, Direction direction);

// Back again. Over a periodic basis of degree p the last p columns are taken from the first p.
// Throws std::invalid_argument where a weight is not positive.
template <int Dim>
NurbsCurve<Dim> CurveOf(const ControlRows& rows);
// `other` is the basis of the other direction.
NurbsSurface SurfaceOf(const ControlRows& rows, Direction direction, const SplineBasis& other);

// The basis of the direction that is not `direction`.
const SplineBasis& OtherBasis(const NurbsSurface& surface, Direction direction);

// The shape after `edit`, which makes ControlRows over the same domain out of ControlRows: trims
// stay as they are.
template <int Dim, typename Edit>
NurbsCurve<Dim> Edited(const NurbsCurve<Dim>& curve, const Edit& edit) {
  return CurveOf<Dim>(edit(RowsOf(curve)));
}
template <typename Edit>
NurbsSurface Edited(const NurbsSurface& surface, Direction direction, const Edit& edit) {
  return SurfaceOf(edit(RowsOf(surface, direction)), direction, OtherBasis(surface, direction))
      .WithTrims(surface.trims());
}

}  // namespace batten::internal
