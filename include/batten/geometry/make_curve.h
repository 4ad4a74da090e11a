// SPDX-License-Identifier: MIT
// Segments, circular and elliptic arcs as exact NURBS on [0, 1].
#pragma once

#include <Eigen/Core>

#include "batten/geometry/frame.h"
#include "batten/geometry/nurbs_curve.h"

namespace batten {

// The segment, of degree 1. Throws std::invalid_argument unless the points are finite and differ.
template <int Dim>
NurbsCurve<Dim> MakeLine(const Eigen::Matrix<double, Dim, 1>& start,
                         const Eigen::Matrix<double, Dim, 1>& end);

// An arc or full circle about the frame's origin in its x-y plane, counter-clockwise: equal
// rational quadratic pieces of 90° at most, weights 1, cos(half a piece), 1, …; a full circle has
// nine control points, and its ends are the same point bit by bit. Multiples of 90° give cosines
// and sines of 0 and ±1 exactly. Throws std::invalid_argument unless radii are positive and finite
// and 0 < sweep ≤ 2π. [Piegl & Tiller 1997, §7.5]
//
// Rounding, as NurbsCurve gives points: within 4 units in the last place of the radius of the
// circle, and 2 more of the largest coordinate where the centre is not the origin or the axis not a
// coordinate axis; twice that as CurveEvaluator gives them.
NurbsCurve<3> MakeArc(const Frame& frame, double radius, const AngleRange& angles = {});
NurbsCurve<2> MakeArc(const Eigen::Vector2d& center, double radius, const AngleRange& angles = {});

// The same in this number of equal pieces. Throws also unless each is of less than 180°, as positive
// weights need. Rounding: flat pieces as above; towards 180° the middle control points go to
// infinity, and rounding grows with their distance.
NurbsCurve<3> MakeArc(const Frame& frame, double radius, const AngleRange& angles, int pieces);

// Full circles with positive weights, from the angle `start` on.
//  kNinePoints: four quarters, as MakeArc. kSevenPoints: three pieces of 120° over a triangle.
//  kDegreeFive: one Bézier piece of degree 5, the lowest that can, infinitely smooth but at its
//  ends; rounding is relative to its control points, which are up to 4.2 radii away: within 16 units
//  in the last place of the radius. [Chou 1995; Piegl & Tiller 1997, §7.5]
enum class CircleForm { kNinePoints, kSevenPoints, kDegreeFive };
NurbsCurve<3> MakeCircle(const Frame& frame, double radius, CircleForm form, double start = 0);

// The same circle by its point at angle zero, the unit directions there, away from the centre and
// forward, and its curvature, one over the radius. Control points are found from `point` and not
// from the centre, so that flat arcs are exact to rounding of their own size.
template <int Dim>
NurbsCurve<Dim> MakeFlatArc(const Eigen::Matrix<double, Dim, 1>& point,
                            const Eigen::Matrix<double, Dim, 1>& outward,
                            const Eigen::Matrix<double, Dim, 1>& forward,
                            double curvature,
                            const AngleRange& angles);

// The ellipse origin + radius_x cos t · x + radius_y sin t · y over the angles t, which are those
// of the circle it is the affine image of. Either radius may be the larger. Pieces, ends and errors
// as above.
NurbsCurve<3> MakeEllipseArc(const Frame& frame,
                             double radius_x,
                             double radius_y,
                             const AngleRange& angles = {});

extern template NurbsCurve<2> MakeLine<2>(const Eigen::Vector2d&, const Eigen::Vector2d&);
extern template NurbsCurve<3> MakeLine<3>(const Eigen::Vector3d&, const Eigen::Vector3d&);
extern template NurbsCurve<2> MakeFlatArc<2>(const Eigen::Vector2d&,
                                             const Eigen::Vector2d&,
                                             const Eigen::Vector2d&,
                                             double,
                                             const AngleRange&);
extern template NurbsCurve<3> MakeFlatArc<3>(const Eigen::Vector3d&,
                                             const Eigen::Vector3d&,
                                             const Eigen::Vector3d&,
                                             double,
                                             const AngleRange&);

}  // namespace batten
