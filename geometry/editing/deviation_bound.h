// SPDX-License-Identifier: MIT
// How far two shapes over the same parameters are apart, at most.
#pragma once

#include <limits>

#include "batten/geometry/bezier_curve.h"
#include "batten/geometry/bezier_surface.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// An upper bound of max ‖a(u) − b(u)‖ over the common domain: the distance of points at the same
// parameter. The difference of every pair of polynomial pieces is a Bézier curve or surface,
// rational if a or b is; its farthest control point bounds it, and pieces are halved where they
// bound worst, until the bound is at most 1 % above the maximum, or of the order of rounding, 8q·ε
// times the size of a piece, q the sum of the degrees, or 20000 halvings are made. Beyond that
// rounding, and that of the shapes' own coordinates, it is certain. The work also stops once the
// maximum is known to exceed `enough`. Throws std::invalid_argument unless the domains are the
// same. [Lane & Riesenfeld 1980]
template <int Dim>
double DeviationBound(const NurbsCurve<Dim>& a,
                      const NurbsCurve<Dim>& b,
                      double enough = std::numeric_limits<double>::infinity());

double DeviationBound(const NurbsSurface& a,
                      const NurbsSurface& b,
                      double enough = std::numeric_limits<double>::infinity());

// The same on [0, 1] and [0, 1]².
template <int Dim>
double DeviationBound(const BezierCurve<Dim>& a, const BezierCurve<Dim>& b);

double DeviationBound(const BezierSurface& a, const BezierSurface& b);

}  // namespace batten::internal
