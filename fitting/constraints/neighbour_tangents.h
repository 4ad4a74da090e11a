// SPDX-License-Identifier: MIT
// The tangent planes along an edge of a surface.
#pragma once

#include "batten/geometry/nurbs_curve.h"
#include "fitting/constraints/boundary_curves.h"

namespace batten::internal {

// The derivative across the edge, out of the neighbour, over the edge's own parameter: exactly for
// a surface without weights, else cubics through it and its derivative on 64 parts of every span,
// whose angle is off by less than 1e-6.
NurbsCurve<3> OutwardDerivative(const NeighbourEdge& edge);

}  // namespace batten::internal
