// SPDX-License-Identifier: MIT
// What part of a line or circle its points cover, and that part as an exact curve.
#pragma once

#include <vector>

#include "fitting/primitives/circle_fit.h"
#include "fitting/primitives/line_fit.h"
#include "batten/geometry/nurbs_curve.h"

namespace batten::internal {

// From `start`, `length` > 0 onwards: along a line in its units, round a circle in radians.
struct Extent {
  double start = 0, length = 0;
  bool full = false;  // all round a circle: length 2π
};

// Of places along a line, at least one.
Extent ExtentOnLine(const std::vector<double>& places);

// Of angles, at least one. All round where no gap between neighbouring angles is above 60°, or
// where the largest is no more than 1.5 times the mean of the others: few points evenly spread.
// Otherwise everything but the largest gap. A full circle starts at the first of the angles.
Extent ExtentOnCircle(const std::vector<double>& angles);

// Without the places that stand alone: those of which no five neighbours in a row lie within six
// times what they do by the median. Some outliers happen to lie near a shape's continuation. All of
// them where there are fewer than 16.
std::vector<double> Supported(const std::vector<double>& places);
std::vector<double> SupportedAngles(const std::vector<double>& angles);

// The segment, of degree 1 on [0, 1].
template <int Dim>
NurbsCurve<Dim> SegmentOf(const FittedLine& line, const Extent& extent);

// The arc or full circle: rational quadratic pieces of 90° at most on [0, 1], counter-clockwise
// about the axis. The curvature must be positive. Control points are found from the circle's point
// and not from its centre, so that flat arcs are exact to rounding of their own size.
// [Piegl & Tiller 1997, §7.5]
template <int Dim>
NurbsCurve<Dim> ArcOf(const FittedCircle& circle, const Extent& extent);

}  // namespace batten::internal
