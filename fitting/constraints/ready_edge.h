// SPDX-License-Identifier: MIT
// An edge condition whose curves stand over the knots of the edge.
#pragma once

#include <optional>
#include <string>

#include "fitting/constraints/surface_constraints.h"

namespace batten::internal {

// An edge made ready: the curve is over knots of the fine basis, about the centre that was asked
// for; the field across has length one at most.
struct ReadyEdge {
  SurfaceEdge edge;
  NurbsCurve<3> curve;  // over the fine basis
  NurbsCurve<3> plain;  // over no more knots than its own
  std::optional<NurbsCurve<3>> across;
  std::string name;  // "the edge u = lower"
};

}  // namespace batten::internal
