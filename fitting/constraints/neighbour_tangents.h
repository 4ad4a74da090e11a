// SPDX-License-Identifier: MIT
// The tangent planes along an edge of a surface.
#pragma once

#include "fitting/constraints/given_sides.h"
#include "batten/geometry/nurbs_curve.h"

namespace batten::internal {

// The derivative across the edge, out of the neighbour, over the edge's own parameter: exactly for
// a surface without weights, else cubics through it and its derivative on 64 parts of every span,
// whose angle is off by less than 1e-6.
NurbsCurve<3> OutwardDerivative(const NeighbourEdge& edge);

}  // namespace batten::internal
