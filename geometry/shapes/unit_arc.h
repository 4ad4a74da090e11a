// SPDX-License-Identifier: MIT
// The arc of radius one about the origin, from which all round shapes are made.
#pragma once

#include <Eigen/Core>

#include "batten/geometry/frame.h"
#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// (cos, sin) of an angle, with multiples of 90° exact: those to which it is as near as rounding.
Eigen::Vector2d UnitVectorAt(double angle);

// Equal rational quadratic pieces of 90° at most on [0, 1]. Its outer control points are the
// parallelogram's of their neighbours where a piece is 90°, and quarter turns of each other are so
// exactly. [Piegl & Tiller 1997, §7.5]
struct UnitArc {
  explicit UnitArc(const AngleRange& angles);
  UnitArc(const AngleRange& angles, int pieces);  // equal ones of less than 180°

  SplineBasis basis;
  Eigen::Matrix2Xd points;
  Eigen::VectorXd less_one;  // their first coordinates less one, without cancellation
  Eigen::VectorXd weights;
};

}  // namespace batten::internal
