// SPDX-License-Identifier: MIT
#include "cli/arguments/plane_curves.h"

#include <algorithm>
#include <utility>
#include <variant>

#include "geometry/nurbs/placed_curve.h"

namespace batten::internal {

void MatchDimensions(std::vector<Geometry>& shapes) {
  const auto plane = [](const Geometry& one) { return std::holds_alternative<NurbsCurve<2>>(one); };
  if (std::all_of(shapes.begin(), shapes.end(), plane)) return;
  for (Geometry& one : shapes) {
    if (const auto* curve = std::get_if<NurbsCurve<2>>(&one)) one = InSpace(*curve);
  }
}

}  // namespace batten::internal
