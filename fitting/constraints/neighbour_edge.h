// SPDX-License-Identifier: MIT
// The edge constraint for a surface that continues a neighbouring surface.
#pragma once

#include "fitting/constraints/surface_constraints.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// The cross-boundary derivative of a non-rational surface at an edge, by the rising parameter, as
// an exact spline along the edge. Throws std::invalid_argument for weights, and where the direction
// across is periodic.
NurbsCurve<3> CrossDerivative(const NurbsSurface& surface, const SurfaceEdge& edge);

// The constraint under which the `own` edge of a surface, over the domain of `along`, continues the
// `theirs` edge of the neighbour, run backwards where `reversed`: its curve and, where `tangent`,
// its tangent planes.
FixedEdge EdgeOfNeighbour(const NurbsSurface& neighbour,
                          const SurfaceEdge& theirs,
                          const SurfaceEdge& own,
                          const SplineBasis& along,
                          bool reversed,
                          bool tangent);

}  // namespace batten::internal
