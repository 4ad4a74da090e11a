// SPDX-License-Identifier: MIT
// Chains of curves as one curve, and the pieces of a curve by name.
#pragma once

#include <vector>

#include "batten/geometry/classify_shape.h"
#include "batten/geometry/nurbs_curve.h"

namespace batten {

// Lines, arcs and free-form curves that meet end to end as one curve that traces each exactly: of
// degree 3, or the highest there is, with knots of that multiplicity at the joints. Curves after
// the first are taken in any order and either sense; among several that fit the first given. The
// first keeps its sense and its parameters unless nothing else begins at its end. Ends up to
// `tolerance` (≥ 0, the data's units) apart are moved together, half the gap each, also where the
// last meets the first; nothing else moves. Throws std::invalid_argument without curves, where a
// gap is larger (the message says how large, and at which curve, by its name among `names`, or its
// number from 1 on), and where a closed or periodic curve is one of several. O(curves² + control
// points · degree).
template <int Dim>
NurbsCurve<Dim> Unified(const std::vector<NurbsCurve<Dim>>& curves,
                        double tolerance,
                        const std::vector<std::string>& names = {});

struct CurvePieceShape {
  double lower, upper;  // the piece, in the curve's parameter
  CurveShape shape;
};

// The curve cut at its knots of full multiplicity, where such chains join; every span of a curve of
// degree 2. Each piece by ClassifyShape; neighbours that together are one line or conic are one
// piece, except at degree 2, where the Bézier pieces stay.
template <int Dim>
std::vector<CurvePieceShape> PieceShapes(const NurbsCurve<Dim>& curve,
                                         const ClassifyOptions& options = {});

}  // namespace batten
