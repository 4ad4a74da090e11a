// SPDX-License-Identifier: MIT
// Degree reduction of curves and surfaces within a tolerance.
#pragma once

#include "batten/geometry/direction.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

template <typename Shape>
struct DegreeReduction {
  Shape shape;
  int reduced;   // by how many degrees
  double error;  // ‖new − old‖ at the same parameter is nowhere greater; see DeviationBound
};

// The curve with a degree less by as many as keep the tolerance (data's units), at most `by`; none
// reduced is the curve itself with error 0. What is tried, from `by` down:
//  (1) Multiplicities of knots fall by the number of degrees, so that the order of continuity stays
//      what it is, but no knot vanishes: one copy is kept, with as much continuity as that has.
//      Clamped, unclamped and periodic ends stay what they are; where knots are then missing up to
//      an end of an unclamped domain, that end and those beyond keep more copies.
//  (2) Control points are those whose elevated ones are nearest to the given ones in the sense of
//      least squares, in homogeneous coordinates divided by the given weight. Where a control point
//      is a point of the curve (clamped ends) it is kept. But for that, on a single Bézier piece
//      without weights the result is nearest in the mean square of the distance.
// A curve that was elevated is found again to rounding, with the knots that it had; only those at
// and beyond the ends of an unclamped domain may differ, because elevation leaves some out.
//
// Where the result is not near, control points that belong to knots far beyond the ends of an
// unclamped domain hardly count and may become large. A rational result needs positive weights: a
// step that would give others does not count as one that keeps the tolerance.
//
// Throws std::invalid_argument when by is negative or ≥ the degree, or the tolerance is negative or
// not a number. O(by·n·p²) for n control points in a row, and the bound. [Piegl & Tiller 1997,
// §5.6, A5.11, with another approximation: Lutterkort, Peters & Reif 1999]
template <int Dim>
DegreeReduction<NurbsCurve<Dim>> Reduced(const NurbsCurve<Dim>& curve, int by, double tolerance);

// The same in one direction of a surface.
DegreeReduction<NurbsSurface> Reduced(const NurbsSurface& surface,
                                      Direction direction,
                                      int by,
                                      double tolerance);

}  // namespace batten
