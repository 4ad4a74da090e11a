// SPDX-License-Identifier: MIT
// Proof that a surface has a normal everywhere, and so no fold.
#pragma once

#include <vector>

#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/parameter_box.h"

namespace batten {

// The boxes of the domain, or of its part inside the trims, on which it is not proved that S_u ×
// S_v keeps its sign along a fixed direction, and so nowhere vanishes or turns back. None: the
// surface has no folds. Along lines of knots where tangent planes may jump the same is proved of
// both sides together, so that no crease turns over; what stays there are boxes without width.
// Boxes that meet a pole or a cusp stay, however small; so does what would take too many halvings
// (kMostBoxes of a knot cell). The sign is that of the Bernstein coefficients of w³ d·(S_u × S_v),
// with a bound of their rounding taken off; cells are halved until it is clear. [Farouki & Rajan
// 1987] O((p+q)⁴) a box.
std::vector<ParameterBox> UnprovedRegularity(const NurbsSurface& surface);

}  // namespace batten
