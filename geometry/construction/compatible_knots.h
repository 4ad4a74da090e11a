// SPDX-License-Identifier: MIT
// Bases, and surfaces over them, brought together.
#pragma once

#include <vector>

#include "batten/geometry/direction.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// Clamped bases of one degree over [0, 1]: inner knots within 1e-12 of one another made one.
std::vector<SplineBasis> Snapped(std::vector<SplineBasis> bases);

// The basis with every knot of all of them as often as any has it.
SplineBasis CommonBasis(const std::vector<SplineBasis>& bases);

// The same surfaces over one clamped basis in each direction, of the highest degree there; domains
// are [0, 1]².
std::vector<NurbsSurface> Compatible(std::vector<NurbsSurface> surfaces);

}  // namespace batten::internal
