// SPDX-License-Identifier: MIT
// The extremes of curvature over a whole curve or surface.
#pragma once

#include <optional>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// What the curvature goes through. Infinite where it grows without bound: in a cusp, at a tip;
// radii below 1e-7 of the size of the control points' box count as that.
struct CurvatureInterval {
  double min, max;
};

// The least and the greatest curvature (not negative) of a curve, one-sided at knots. Every span is
// sampled at 4 p + 9 places and each extreme of the samples is followed to 1e-8 of the span
// (golden section), so that values are attained and right to 1e-9 of themselves; an extreme
// narrower than two samples can be missed. None where there is no curvature: a single point.
template <int Dim>
std::optional<CurvatureInterval> CurvatureRange(const NurbsCurve<Dim>& curve);

// The least lower and the greatest upper principal curvature, from a grid of samples on every pair
// of spans (2 max(p,q) + 3 a side, fewer where these would be more than 400 000 in all), followed
// from the eight best pieces by at most 400 steps of a pattern search. Where S_u × S_v falls below
// 1e-4 of its usual size, curvature is lost to rounding and only asked whether it is unbounded.
// Values are attained; how near they are to the extremes is not proved. None where the surface has
// no normal anywhere. Of a trimmed surface only samples inside its trims count, and places on the
// loops (the vertices of polygons within 1e-3 of the domain) besides; steps stay inside.
std::optional<CurvatureInterval> CurvatureRange(const NurbsSurface& surface);

extern template std::optional<CurvatureInterval> CurvatureRange(const NurbsCurve<2>&);
extern template std::optional<CurvatureInterval> CurvatureRange(const NurbsCurve<3>&);

}  // namespace batten
