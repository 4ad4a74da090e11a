// SPDX-License-Identifier: MIT
// Curves at a distance from others.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/offset_options.h"

namespace batten {

// Where an offset curve meets itself, by its parameters.
template <int Dim>
struct CurveSelfMeeting {
  double first, second;
  Eigen::Matrix<double, Dim, 1> point;
};

template <int Dim>
struct CurveOffset {
  NurbsCurve<Dim> curve;
  bool exact = false;    // a line or circle, in the form that the curve has
  double deviation = 0;  // measured at 9 places between knots, at equal parameters; 0 where exact
  std::vector<CurveSelfMeeting<Dim>> self_meetings;
};

// The curve C + d·W, W the direction to the left of the curve: of a curve in space n × C' over its
// length, that is left as seen from the tip of n. |d| may be negative: to the right. Lines, and
// circles about the normal, of any degree and parameter keep their form exactly; all else becomes a
// cubic that is C¹ where the curve is C² and keeps the curve's parameter, cubics halved until
// each is within the tolerance at seven places, at equal parameters. At a corner of the curve an
// arc about it is put in, and parameters behind it are shifted by one hundredth of the domain.
//
// Throws std::invalid_argument where the distance is zero or not finite, the tolerance not
// positive, the curve stands still or runs along the normal; and where the distance is beyond the
// radius of curvature on its side: the message names the smallest radius and its parameter.
// O(pieces of the result²) for the self-meetings. [Hoschek 1988; Tiller & Hanson 1984]
CurveOffset<2> OffsetCurve(const NurbsCurve<2>& curve,
                           double distance,
                           const OffsetOptions& options = {});
CurveOffset<3> OffsetCurve(const NurbsCurve<3>& curve,
                           const Eigen::Vector3d& normal,
                           double distance,
                           const OffsetOptions& options = {});

// What of the offset of `curve` is nowhere nearer to it than the distance: cut where it meets
// itself, the loops between left out, what is left joined, in order. One curve, or several where
// it falls apart; none where nothing is left.
template <int Dim>
std::vector<NurbsCurve<Dim>> WithoutLoops(const CurveOffset<Dim>& offset,
                                          const NurbsCurve<Dim>& curve,
                                          double distance,
                                          const OffsetOptions& options = {});

extern template std::vector<NurbsCurve<2>> WithoutLoops(const CurveOffset<2>&,
                                                        const NurbsCurve<2>&,
                                                        double,
                                                        const OffsetOptions&);
extern template std::vector<NurbsCurve<3>> WithoutLoops(const CurveOffset<3>&,
                                                        const NurbsCurve<3>&,
                                                        double,
                                                        const OffsetOptions&);

}  // namespace batten
