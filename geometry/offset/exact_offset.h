// SPDX-License-Identifier: MIT
// Offsets of planes, cylinders, cones, spheres and tori in the form that they have. Internal to
// geometry.
#pragma once

#include <optional>

#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// The exact offset, without trims; none where the surface is none of these in a form known. Throws
// std::invalid_argument for a torus on both sides of the place where it meets its axis.
std::optional<NurbsSurface> ExactSurfaceOffset(const NurbsSurface& surface, double distance);

}  // namespace batten::internal
