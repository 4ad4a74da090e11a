// SPDX-License-Identifier: MIT
// An edge of a neighbour as one that a surface has to meet.
#pragma once

#include "fitting/constraints/surface_constraints.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// The derivative of a surface without weights across one of its edges, by the rising parameter, as
// a spline along the edge: exact. Throws std::invalid_argument for weights, and where the direction
// across is periodic.
NurbsCurve<3> CrossDerivative(const NurbsSurface& surface, const SurfaceEdge& edge);

// What makes `own` edge of a surface, over the domain of `along`, go on from the `theirs` edge of
// the neighbour, run backwards where `reversed`: its curve, and where `tangent` its tangent planes.
FixedEdge EdgeOfNeighbour(const NurbsSurface& neighbour,
                          const SurfaceEdge& theirs,
                          const SurfaceEdge& own,
                          const SplineBasis& along,
                          bool reversed,
                          bool tangent);

}  // namespace batten::internal
