// SPDX-License-Identifier: MIT
// Surfaces that are their own mirror image.
#pragma once

#include "batten/fitting/mirror_plane.h"
#include "batten/geometry/direction.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// The symmetric surface next to one that nearly is: the control points (and weights) i and
// n − 1 − i of the direction become mirror images of one another, each moved by half of what they
// are off, and those of a middle row come to lie in the plane. So S(lower + upper − u, v) is the
// mirror image of S(u, v), to rounding. Knots are made symmetric where they are to 1e-9 of the
// domain; trim loops are kept. Throws std::invalid_argument where they are not.
NurbsSurface SymmetricNet(const NurbsSurface& surface,
                          Direction direction,
                          const MirrorPlane& plane);

// How far the control points move for that, at most.
double Asymmetry(const NurbsSurface& surface, Direction direction, const MirrorPlane& plane);

}  // namespace batten::internal
