// SPDX-License-Identifier: MIT
// The sides of holes.
#pragma once

#include <optional>

#include "batten/geometry/joins.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// One side of a hole: a curve, or the edge of a surface whose tangent planes are to go on.
struct FillSide {
  NurbsCurve<3> curve;
  std::optional<NurbsSurface> neighbour = {};
  SurfaceEdge edge = {};
};
FillSide SideOf(const NurbsSurface& neighbour, const SurfaceEdge& edge);

}  // namespace batten
