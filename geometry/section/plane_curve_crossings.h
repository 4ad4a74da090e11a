// SPDX-License-Identifier: MIT
// Where two curves of the plane cross. Internal to geometry.
#pragma once

#include <vector>

#include "batten/geometry/nurbs_curve.h"

namespace batten::internal {

// Parameters on both curves and the place.
struct CurveCrossing {
  double s, t;
  Eigen::Vector2d at;
};

// All places where the curves come within `tolerance` of each other, those nearer than 100
// tolerances to one another counting as one. Bézier pieces are halved until their boxes part or
// both are nearly straight and one place can be solved for by Newton's method. Throws
// std::invalid_argument where the curves run along each other. [Sederberg & Parry 1986, survey]
std::vector<CurveCrossing> CurveCrossings(const NurbsCurve<2>& a,
                                          const NurbsCurve<2>& b,
                                          double tolerance);

}  // namespace batten::internal
