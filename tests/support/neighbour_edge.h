// SPDX-License-Identifier: MIT
// Constraints for a surface that continues a neighbour.
#pragma once

#include "batten/geometry/iso_curve.h"
#include "fitting/constraints/neighbour_tangents.h"
#include "fitting/constraints/surface_constraints.h"

namespace batten::internal {

// The constraint under which the `own` edge of a surface continues the `theirs` edge of a neighbour
// over the same domain: its curve and, where `tangent`, its tangent planes.
inline FixedEdge EdgeOfNeighbour(const NurbsSurface& neighbour,
                                 const SurfaceEdge& theirs,
                                 const SurfaceEdge& own,
                                 bool tangent) {
  const SplineBasis& across =
      theirs.direction == Direction::kU ? neighbour.basis_u() : neighbour.basis_v();
  FixedEdge edge{
      own, IsoCurve(neighbour, theirs.direction, theirs.upper ? across.upper() : across.lower())};
  if (!tangent) return edge;
  const NurbsCurve<3> outward = OutwardDerivative({neighbour, theirs.direction, theirs.upper});
  // Out of the neighbour is into this surface, but the parameter rises out of an upper edge.
  edge.across = own.upper ? NurbsCurve<3>(outward.basis(), -outward.control_points()) : outward;
  return edge;
}

}  // namespace batten::internal
