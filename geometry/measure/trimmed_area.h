// SPDX-License-Identifier: MIT
// The area of the part of a surface inside its trims. Internal to geometry.
#pragma once

#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/parameter_box.h"

namespace batten::internal {

// ∫∫ |S_u × S_v| du dv over the part of a box of the domain inside the surface's trims, of which it
// has some, turned as NurbsSurface says. In every pair of knot spans that a loop passes, by Green's
// theorem, ∮ (∫ |S_u × S_v| du) dv along the loop and along the span's far side where the part
// reaches beyond it: products of Gauss–Legendre rules of 12 × 12 and 8 × 8 nodes between the arc
// and the span's near side, which are cut into four, worst first, until they differ by less than
// 1e-10 of the sum of their areas. Pairs of spans that no loop passes are left to
// UntrimmedArea.
double TrimmedArea(const NurbsSurface& surface, const ParameterBox& box);

}  // namespace batten::internal
