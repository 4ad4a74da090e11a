// SPDX-License-Identifier: MIT
// The area of surfaces.
#pragma once

#include "batten/geometry/nurbs_surface.h"

namespace batten {

// ∫∫ |S_u × S_v| du dv over the domain, in squares of the data's units; what is covered twice
// counts twice. Gauss–Legendre rules of 12 × 12 and 8 × 8 nodes on every pair of knot spans. A cell
// is cut into four where the two differ, and where the Bézier points of S_u and S_v do not prove
// that the two stay apart in direction, until what is uncertain sums to less than 1e-10 of the
// area, a generous estimate of the error, collapsed edges and corners included, or at the rounding
// of the control points. Along a fold in its own plane, where a surface turns back upon itself,
// cells are cut until the work is bounded; 1e-9 is still kept there. O(cells · p q), from 10 µs for
// a pair of cubic spans. [Davis & Rabinowitz 1984, §5.6, §6.2]
double Area(const NurbsSurface& surface);

// Of a trimmed surface, here and below, the area of the part inside its trims, which must be turned
// as NurbsSurface says (TurnedLoops). Pairs of knot spans that a loop passes are measured between
// the loop and one of their sides, to 1e-10 of the sum of what that adds and subtracts; there folds
// between the nodes of a rule are not looked for.

// The area over [u0, u1] × [v0, v1], relative to that area as exact as above. In a periodic
// direction the rectangle may begin anywhere and reach up to one period. Throws
// std::invalid_argument unless u0 ≤ u1, v0 ≤ v1 and, where not periodic, all are in the domain.
double Area(const NurbsSurface& surface, double u0, double u1, double v0, double v1);

}  // namespace batten
