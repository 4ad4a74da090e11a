// SPDX-License-Identifier: MIT
// Where curves in the domain of a surface are divided into straight pieces. Internal to geometry.
#pragma once

#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/surface_evaluator.h"

namespace batten::internal {

// Parameters of a loop, its corners and ends of spans among them, but for the last, between whose
// places straight lines, in the domain or in space, leave the loop on the surface by no more than
// the tolerance.
std::vector<double> LoopParameters(const NurbsCurve<2>& loop,
                                   const SurfaceEvaluator& surface,
                                   double tolerance);

// The same with as few ends of spans as may be, and with lines in the domain that are no more than
// `beside` from the curve across their way: to part what a face needs from what its neighbour does.
std::vector<double> EdgeParameters(const NurbsCurve<2>& curve,
                                   const SurfaceEvaluator& surface,
                                   double tolerance,
                                   double beside);

}  // namespace batten::internal
