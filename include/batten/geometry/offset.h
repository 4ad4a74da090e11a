// SPDX-License-Identifier: MIT
// Curves and surfaces at a distance from others.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

struct OffsetOptions {
  // How far the offset may be from the exact one, > 0, in the data's units; none: 1e-6 of the
  // diagonal of the box of the control points.
  std::optional<double> tolerance = std::nullopt;
};

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

// Where an offset surface meets itself.
struct SurfaceSelfMeeting {
  Eigen::Vector2d first, second;
  Eigen::Vector3d point;
};

struct SurfaceOffset {
  NurbsSurface surface;
  bool exact = false;
  double deviation = 0;  // measured at 25 places between knots, at equal parameters; 0 where exact
  bool tolerance_reached = true;
  std::vector<SurfaceSelfMeeting> self_meetings;  // at most 100 places
};

// The surface S + d·n, n the unit normal S_u × S_v / |…| and its limits at poles. Planes, spheres
// and cylinders of any parameter, and cones and tori as MakeCone and MakeTorus make them, keep
// their form exactly. All else becomes the bicubic that interpolates at Greville places, over knots
// that are the surface's own, one smoothness less, and as many between as the tolerance needs; up
// to 400 rows, then the nearest found is given. Parameters and trims stay.
//
// Throws std::invalid_argument where the distance is zero or not finite, the tolerance not
// positive, where there is no normal, at a crease (naming the knot), and where the distance is
// beyond a radius of curvature on its side: the message names the smallest radius and its place.
// Curvatures are sampled at 25 places a cell and followed to their greatest.
SurfaceOffset OffsetSurface(const NurbsSurface& surface,
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
