// SPDX-License-Identifier: MIT
// Knot spans too narrow to be walked through.
#pragma once

#include "batten/geometry/direction.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// Refuses a surface that moves by more than a tolerance across a knot span narrower than 2^-28 of
// its domain: between two places so near no triangle and no point of a section can be put. Throws
// std::invalid_argument naming the function and the span.
void RefuseNarrowSpans(const char* function, const NurbsSurface& surface, double tolerance);

}  // namespace batten::internal
