// SPDX-License-Identifier: MIT
#include "batten/geometry/fill_side.h"

#include "batten/geometry/iso_curve.h"
#include "geometry/nurbs/homogeneous.h"

namespace batten {

FillSide SideOf(const NurbsSurface& neighbour, const SurfaceEdge& edge) {
  const SplineBasis& across = internal::BasisOf(neighbour, edge.direction);
  return {IsoCurve(neighbour, edge.direction, edge.upper ? across.upper() : across.lower()),
          neighbour,
          edge};
}

}  // namespace batten
