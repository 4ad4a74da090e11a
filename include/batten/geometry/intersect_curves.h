// SPDX-License-Identifier: MIT
// Where curves meet curves, lines and surfaces.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/frame.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// A place that two curves have in common, to the tolerance.
template <int Dim>
struct CurveMeeting {
  double first, second;  // the parameters
  Eigen::Matrix<double, Dim, 1> point;
  double distance;  // of the two points; the given point is halfway
  bool tangential;  // they touch: their directions are the same there
};

// A stretch along which two curves are the same, to the tolerance. The second interval may run
// from its upper to its lower number.
struct CurveOverlap {
  Interval first, second;
};

template <int Dim>
struct CurveIntersection {
  std::vector<CurveMeeting<Dim>> points;  // by the first parameter
  std::vector<CurveOverlap> overlaps;
};

// All places where the curves are within `tolerance` (> 0, in the data's units) of each other.
// Pairs of Bézier arcs are halved until their hulls are farther apart than that; or their tangent
// cones share no direction, so that they come nearest once, at a place that Newton's method finds;
// or both are straight to an eighth of the tolerance and run alike, and their distances are
// measured by certified foot points. What lasts no longer than 8 √(tolerance · size) is a
// tangential point, longer is an overlap. So none is missed. Two meetings are one where they are
// within four tolerances in space and next to each other in parameters, over a seam too. The size
// is the smaller diagonal of the boxes of control points. Throws std::invalid_argument unless the
// tolerance is positive and finite, and where a million pairs do not tell the curves apart: the
// message says where. [Sederberg & Nishita 1990; Lane & Riesenfeld 1980]
template <int Dim>
CurveIntersection<Dim> IntersectCurves(const NurbsCurve<Dim>& first,
                                       const NurbsCurve<Dim>& second,
                                       double tolerance);

// The same for the whole line through a point: `second` is the distance along the direction, which
// need not have length one. Throws std::invalid_argument also where the direction is zero or not
// finite.
template <int Dim>
CurveIntersection<Dim> IntersectLine(const NurbsCurve<Dim>& curve,
                                     const Eigen::Matrix<double, Dim, 1>& through,
                                     const Eigen::Matrix<double, Dim, 1>& direction,
                                     double tolerance);

struct CurveSurfaceMeeting {
  double on_curve;
  Eigen::Vector2d on_surface;
  Eigen::Vector3d point;
  double distance;
  bool tangential;  // the curve touches the surface
};

struct CurveSurfaceOverlap {
  Interval on_curve;
  Eigen::Vector2d from, to;  // on the surface
};

struct CurveSurfaceIntersection {
  std::vector<CurveSurfaceMeeting> points;  // by the curve's parameter
  std::vector<CurveSurfaceOverlap> overlaps;
};

// The same for a curve and a surface; of a trimmed surface the part inside its loops counts.
CurveSurfaceIntersection IntersectCurveSurface(const NurbsCurve<3>& curve,
                                               const NurbsSurface& surface,
                                               double tolerance);

extern template CurveIntersection<2> IntersectCurves(const NurbsCurve<2>&,
                                                     const NurbsCurve<2>&,
                                                     double);
extern template CurveIntersection<3> IntersectCurves(const NurbsCurve<3>&,
                                                     const NurbsCurve<3>&,
                                                     double);
extern template CurveIntersection<2> IntersectLine(const NurbsCurve<2>&,
                                                   const Eigen::Vector2d&,
                                                   const Eigen::Vector2d&,
                                                   double);
extern template CurveIntersection<3> IntersectLine(const NurbsCurve<3>&,
                                                   const Eigen::Vector3d&,
                                                   const Eigen::Vector3d&,
                                                   double);

}  // namespace batten
