// SPDX-License-Identifier: MIT
// Several curves as cubics without weights over common knots.
#pragma once

#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "geometry/construction/cubic_approximation.h"

namespace batten::internal {

struct CurvesTogether {
  std::vector<NurbsCurve<3>> curves;
  double error;  // largest distance found from what they stand for, at equal parameters
};

// The curves, over [0, 1] each, within the tolerance (data's units, above 0), as clamped cubics
// over common knots. Kinks stay kinks.
CurvesTogether AsCubics(const std::vector<NurbsCurve<3>>& curves,
                        double tolerance,
                        const char* function);

// A curve traced by another parameter: the place u on the curve and du/ds.
struct Retracing {
  double at, pace;
};

// The same of curves retraced by functions s ↦ u that increase, with the places of s that are to be
// met and how smooth the functions are there; the ends of the domain are among them.
using RetracingFunction = std::function<Retracing(std::size_t curve, double s, Side side)>;
CurvesTogether RetracedCubics(const std::vector<NurbsCurve<3>>& curves,
                              const RetracingFunction& retracing,
                              const std::vector<FunctionBreak>& breaks,
                              double tolerance,
                              const char* function);

// The breaks in order, those nearer than 1e-9 of the domain to one another as one, the ends kept.
std::vector<FunctionBreak> MergedBreaks(std::vector<FunctionBreak> breaks);

}  // namespace batten::internal
