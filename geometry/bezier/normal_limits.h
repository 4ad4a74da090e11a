// SPDX-License-Identifier: MIT
// Normals where S_u × S_v vanishes: collapsed edges, coincident corner points, parallel tangents.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// The limit of S_u × S_v / |S_u × S_v| at (u, v) from inside the piece that derivatives there mean
// (to the right at knots, to the left at the end of the domain). Along each of a fan of rays of
// parameters the first coefficient of the power series of S_u × S_v that is more than rounding
// gives the limit; on the edge itself, where all vanish, there is none to ask. The answer is the
// common limit of all rays, and none if they differ:
//  (1) a collapsed edge has one normal for each parameter along it, the limit at that parameter
//      constant (S_uv × S_v for S_u = 0). At the pole of a sphere all are the same; at the tip of a
//      cone each ruling has its own;
//  (2) a corner with two coincident control points or parallel tangents has a normal where the
//      surface is smooth there; else its limits depend on the direction: none;
//  (3) where the surface is folded or turns back, opposite limits meet: none; so along an inner
//      line that is collapsed within a piece, but not at one collapsed at a knot, which is (1);
//  (4) within a thousandth of a piece of a collapsed edge, where the value is lost to rounding, the
//      limit at the edge stands for it.
// Where S_u × S_v is regular it is that. Powers up to the tenth are looked at. Some 10 … 100 µs for
// cubics; NurbsSurface::NormalAt calls it only where S_u × S_v is suspiciously small.
// [Piegl & Tiller 1997, §1.5 for the first-order case]
std::optional<Eigen::Vector3d> LimitNormal(const NurbsSurface& surface, double u, double v);

}  // namespace batten::internal
