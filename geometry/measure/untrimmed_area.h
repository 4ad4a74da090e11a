// SPDX-License-Identifier: MIT
// The area of a rectangle of the domain of a surface, its trims left out of account. Internal to
// geometry.
#pragma once

#include <vector>

#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// A stretch of parameters inside the domain.
struct DomainStretch {
  double low, high;
};

// [low, high] brought into the domain: over a periodic basis one across the seam is two. Throws
// std::invalid_argument, naming the direction `name`, unless low ≤ high and [low, high] is inside
// the domain or, over a periodic basis, no longer than one period.
std::vector<DomainStretch> StretchesInDomain(const SplineBasis& basis,
                                             double low,
                                             double high,
                                             const char* name);

// ∫∫ |S_u × S_v| du dv over [u0, u1] × [v0, v1], as Area (surface_area.h) says for a surface that
// is not trimmed.
double UntrimmedArea(const NurbsSurface& surface, double u0, double u1, double v0, double v1);

}  // namespace batten::internal
