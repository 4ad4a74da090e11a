// SPDX-License-Identifier: MIT
// Plane curves beside those in space.
#pragma once

#include <vector>

#include "batten/io/geometry_types.h"

namespace batten::internal {

// Plane curves in space where anything else is among the shapes.
void MatchDimensions(std::vector<Geometry>& shapes);

}  // namespace batten::internal
