// SPDX-License-Identifier: MIT
// Edges of surfaces that lie on another surface. Internal to geometry.
#pragma once

#include <array>
#include <vector>

#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/surface_intersection.h"

namespace batten::internal {

// Which edges of a domain to look at: u lower, u upper, v lower, v upper.
using EdgeChoice = std::array<bool, 4>;

// Adds the stretches of the chosen edges of both surfaces that lie on the other one and along which
// no branch passes yet: of kind kOverlap beside a region in which the two coincide, tangential
// where their planes are the same all along, else transversal. A branch that runs along a part of
// a stretch gives way to it. Edges shorter than the tolerance, poles among them, do not count, nor
// do the surfaces' trims. Touches along a tangential stretch are taken away.
void AddSharedEdges(const NurbsSurface& first,
                    const EdgeChoice& of_first,
                    const NurbsSurface& second,
                    const EdgeChoice& of_second,
                    SurfaceIntersection& met);

}  // namespace batten::internal
