// SPDX-License-Identifier: MIT
// An edge constraint refined to the knots of the fine basis.
#pragma once

#include <optional>
#include <string>

#include "fitting/constraints/surface_constraints.h"

namespace batten::internal {

// An edge whose curve is over the knots of the fine basis, relative to the given centre; the field
// across has length one at most.
struct ReadyEdge {
  SurfaceEdge edge;
  NurbsCurve<3> curve;  // over the fine basis
  NurbsCurve<3> plain;  // over its own knots only
  std::optional<NurbsCurve<3>> across;
  std::string name;  // "the edge u = lower"
};

}  // namespace batten::internal
