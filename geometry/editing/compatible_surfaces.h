// SPDX-License-Identifier: MIT
// Two surfaces over one basis in a direction.
#pragma once

#include "batten/geometry/direction.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// Both of the higher degree of the two.
void RaiseToSameDegree(NurbsSurface& a, NurbsSurface& b, Direction direction);

// Both over one basis in `direction`, of equal degree there: the second's domain becomes the
// first's, and knots are merged, those within 1e-12 of the domain's length as one.
void PutOverSameKnots(NurbsSurface& a, NurbsSurface& b, Direction direction);

}  // namespace batten::internal
