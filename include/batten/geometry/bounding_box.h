// SPDX-License-Identifier: MIT
// The smallest axis-aligned box of a curve or surface.
#pragma once

#include <Eigen/Geometry>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// Every side touches the shape: it passes through a point of the shape, and no point of the shape
// lies beyond it by more than 1e-14 of the box of the control points plus the rounding of the
// largest coordinate. Each of the 2·Dim extremes is found by halving the Bézier piece whose control
// points, which enclose it, reach farthest, until none reaches beyond the farthest point found.
// O(pieces · p²), and about 25 halvings for an extreme between knots. Where a surface has
// its extreme along a whole curve that is no parameter line, the work is bounded, and that side
// is the control points' bound instead, at most 1e-8 of the size beyond the surface.
// [Piegl & Tiller 1997, §4.2 P4.5, strong convex hull; Lane & Riesenfeld 1980]
// Of a trimmed surface the box of the part inside its trims: inside them as above, to 1e-12; along
// the loops from samples, the greatest of which are followed, so that an extreme narrower than two
// of them can be missed.
template <int Dim>
Eigen::AlignedBox<double, Dim> BoundingBox(const NurbsCurve<Dim>& curve);
Eigen::AlignedBox3d BoundingBox(const NurbsSurface& surface);

extern template Eigen::AlignedBox<double, 2> BoundingBox(const NurbsCurve<2>&);
extern template Eigen::AlignedBox<double, 3> BoundingBox(const NurbsCurve<3>&);

}  // namespace batten
