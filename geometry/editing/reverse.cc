// SPDX-License-Identifier: MIT
#include "batten/geometry/reverse.h"

#include "geometry/editing/control_rows.h"
#include "geometry/editing/trim_maps.h"

namespace batten {
using namespace internal;

template <int Dim>
NurbsCurve<Dim> Reversed(const NurbsCurve<Dim>& curve) {
  return Edited(curve, ReversedRows);
}

NurbsSurface Reversed(const NurbsSurface& surface, Direction direction) {
  const SplineBasis& basis = direction == Direction::kU ? surface.basis_u() : surface.basis_v();
  return Edited(surface, direction, ReversedRows)
      .WithTrims(ReversedTrims(surface.trims(), direction, basis));
}

NurbsSurface Swapped(const NurbsSurface& surface) {
  // The rows across u, read as rows across v.
  return SurfaceOf(RowsOf(surface, Direction::kU), Direction::kV, surface.basis_v())
      .WithTrims(SwappedTrims(surface.trims()));
}

template NurbsCurve<2> Reversed(const NurbsCurve<2>&);
template NurbsCurve<3> Reversed(const NurbsCurve<3>&);

}  // namespace batten
