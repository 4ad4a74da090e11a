// SPDX-License-Identifier: MIT
// Control points as homogeneous columns (w·P, w), so that editing one direction is one linear
// operation for curves and surfaces, rational or not.
#pragma once

#include <Eigen/Core>

#include "batten/geometry/direction.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// (Dim + 1) × n: column i is (w_i·P_i, w_i), with w_i = 1 where the curve is not rational.
template <int Dim>
Eigen::MatrixXd Homogeneous(const NurbsCurve<Dim>& curve);

// The curve over `basis` with these homogeneous control points; `rational` false sets all weights
// to one, so that non-rational stays so bit by bit. Over a periodic basis the last p columns are
// taken from the first p. Throws std::invalid_argument where a weight is not positive.
template <int Dim>
NurbsCurve<Dim> CurveFromHomogeneous(SplineBasis basis,
                                     const Eigen::MatrixXd& columns,
                                     bool rational);

// The basis of a direction.
const SplineBasis& BasisOf(const NurbsSurface& surface, Direction direction);

// One column for each control point along `direction`, holding the homogeneous points of its whole
// row of the net, one below the other: 4·m × n with m the size of the other direction.
Eigen::MatrixXd HomogeneousRows(const NurbsSurface& surface, Direction direction);

// The surface whose basis in `direction` is `basis` and whose net in that direction is `columns`;
// the other basis is that of `like`. The same rules as for curves.
NurbsSurface SurfaceFromHomogeneous(const NurbsSurface& like,
                                    Direction direction,
                                    SplineBasis basis,
                                    const Eigen::MatrixXd& columns);

}  // namespace batten::internal
