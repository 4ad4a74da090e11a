// SPDX-License-Identifier: MIT
// Control nets symmetric under a reflection.
#pragma once

#include "batten/fitting/mirror_plane.h"
#include "batten/geometry/direction.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// Symmetrises a nearly symmetric surface: the control points (and weights) i and n − 1 − i of the
// direction become mirror images of one another, each moved by half of the difference, and those of
// a middle row are projected onto the plane. So S(lower + upper − u, v) is the mirror image of S(u,
// v), to rounding. Knots symmetric to 1e-9 of the domain are made exactly symmetric; trim loops are
// kept. Throws std::invalid_argument where the knots are not.
NurbsSurface SymmetricNet(const NurbsSurface& surface,
                          Direction direction,
                          const MirrorPlane& plane);

}  // namespace batten::internal
