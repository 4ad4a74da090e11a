// SPDX-License-Identifier: MIT
// Plane curves beside those in space.
#pragma once

#include <vector>

#include "batten/io/geometry_types.h"

namespace batten::internal {

// The curve at z = 0.
NurbsCurve<3> InSpace(const NurbsCurve<2>& curve);

// Plane curves in space where anything else is among the shapes.
void MatchDimensions(std::vector<Geometry>& shapes);

}  // namespace batten::internal
