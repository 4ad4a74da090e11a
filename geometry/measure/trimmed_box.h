// SPDX-License-Identifier: MIT
// The box of the part of a surface inside its trims. Internal to geometry.
#pragma once

#include <Eigen/Geometry>

#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// The box of a surface that has trims. An extreme of a coordinate lies on a loop or inside. Along
// the loops, between knots of loop and surface, 8 (p + q) samples an arc are taken and the greatest
// are followed by golden section. Inside, Bézier pieces that reach farther than the farthest place
// known are halved: those outside the loops are dropped, and of those that a loop passes and over
// which the coordinate grows in one direction only the far edge is kept, then its far end. Where
// the work, bounded by 20000 halvings a side, does not end, that side is the control points' bound.
Eigen::AlignedBox3d TrimmedBox(const NurbsSurface& surface);

}  // namespace batten::internal
