// SPDX-License-Identifier: MIT
// The cross-boundary derivative along an edge of a neighbouring surface.
#pragma once

#include "batten/geometry/nurbs_curve.h"
#include "fitting/constraints/boundary_curves.h"

namespace batten::internal {

// The derivative across the edge, outward from the neighbour, over the edge's own parameter: exact
// for a non-rational surface, else Hermite cubics on 64 parts of every span with an angle error
// below 1e-6.
NurbsCurve<3> OutwardDerivative(const NeighbourEdge& edge);

}  // namespace batten::internal
