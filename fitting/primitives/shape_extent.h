// SPDX-License-Identifier: MIT
// The extent that points cover on a line or circle, and that part as an exact NURBS curve.
#pragma once

#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "fitting/primitives/circle_fit.h"
#include "fitting/primitives/line_fit.h"

namespace batten::internal {

// The extent from `start` over `length` > 0: along a line in its units, round a circle in radians.
struct Extent {
  double start = 0, length = 0;
  bool full = false;  // all round a circle: length 2π
};

// The extent of one or more places along a line.
Extent ExtentOnLine(const std::vector<double>& places);

// The extent of one or more angles: the full circle, from the first of them, where they lie all
// round it (AllRound), else everything but the widest gap.
Extent ExtentOnCircle(const std::vector<double>& angles);

// The places without isolated ones: a place is isolated where each window of five neighbours around
// it is more than six times as wide as the median window. Some outliers happen to lie near a
// shape's continuation. Fewer than 16 places are all kept.
std::vector<double> Supported(const std::vector<double>& places);
std::vector<double> SupportedAngles(const std::vector<double>& angles);

// The segment as a NURBS curve of degree 1 on [0, 1].
template <int Dim>
NurbsCurve<Dim> SegmentOf(const FittedLine& line, const Extent& extent);

// The arc or full circle as a NURBS curve on [0, 1], of rational quadratic pieces of 90° at most,
// counter-clockwise about the axis. The curvature must be positive. Control points are found from
// the circle's point and not from its centre, so that flat arcs are exact to rounding of their own
// size. [Piegl & Tiller 1997, §7.5]
template <int Dim>
NurbsCurve<Dim> ArcOf(const FittedCircle& circle, const Extent& extent);

}  // namespace batten::internal
