// SPDX-License-Identifier: MIT
// A curve in space brought onto a surface.
#pragma once

#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// The foot points of a space curve as curves in the surface's parameter domain: cubic and C¹, over
// the curve's own parameter, their points within `tolerance` (> 0, in the data's units) of the foot
// points at equal parameters. Where feet lie on an edge of the domain because the curve goes on
// past it, nothing is returned, so one curve may give several. A closed curve gives a closed one.
// Throws std::invalid_argument unless the tolerance is positive, and where the feet jump: at a
// seam, or because the curve is farther from the surface than the surface bends.
// O(pieces) foot points.
std::vector<NurbsCurve<2>> ProjectedCurve(const NurbsSurface& surface,
                                          const NurbsCurve<3>& curve,
                                          double tolerance);

}  // namespace batten
