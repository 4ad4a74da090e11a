// SPDX-License-Identifier: MIT
#include "io/exchange/closed_form.h"

#include <variant>

#include "batten/geometry/clamp.h"

namespace batten::internal {
namespace {

template <int Dim>
Geometry Closed(const NurbsCurve<Dim>& curve) {
  return curve.basis().periodic() ? Clamped(curve) : curve;
}
Geometry Closed(const NurbsSurface& surface) {
  NurbsSurface closed = surface;
  if (surface.basis_u().periodic()) closed = Clamped(closed, Direction::kU);
  if (surface.basis_v().periodic()) closed = Clamped(closed, Direction::kV);
  return closed.WithTrims(surface.trims());
}

}  // namespace

Geometry ClosedForm(const Geometry& geometry) {
  return std::visit([](const auto& one) { return Closed(one); }, geometry);
}

}  // namespace batten::internal
