// SPDX-License-Identifier: MIT
// What holds of the curves and surfaces that a reader of geometry gives.
#pragma once

#include <vector>

#include "batten/io/geometry_file.h"

namespace batten::internal {

// Throws BrokenLaw unless there is a geometry, points on it are finite, and it is the same again
// after writing and reading it as JSON.
void RequireGeometryLaws(const std::vector<Geometry>& geometry);

}  // namespace batten::internal
