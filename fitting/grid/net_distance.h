// SPDX-License-Identifier: MIT
// Upper bound of the distance between two surfaces from their control nets over common knots.
#pragma once

#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// An upper bound of max ‖a(u,v) − b(u,v)‖ over the common domain of two polynomial surfaces of the
// same degrees, both open or both periodic in a direction: the largest distance of control points
// over the knots of both, with each span of theirs cut into `cuts` equal parts. It is above the
// maximum by a part that falls with the square of the spans' width. Certain to rounding. O(n), n
// the control points over the common knots. [Lane & Riesenfeld 1980]
double NetDistance(const NurbsSurface& a, const NurbsSurface& b, int cuts = 1);

}  // namespace batten::internal
