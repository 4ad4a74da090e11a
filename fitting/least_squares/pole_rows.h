// SPDX-License-Identifier: MIT
// Pole conditions as ties on the rows of the normal matrix.
#pragma once

#include "batten/fitting/poles.h"
#include "fitting/linear/tied_system.h"
#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// The unknowns that PoleConditions leave free, on the rows of the normal matrix: those of the outer
// basis in its CoefficientOrder, inside each the different inner coefficients.
NetTies PoleTies(const SplineBasis& basis_u,
                 const SplineBasis& basis_v,
                 const Poles& poles,
                 bool u_outside);

}  // namespace batten::internal
