// SPDX-License-Identifier: MIT
// Surfaces whose net is made of two control polygons: one curve moved along another without
// turning, or swung round an axis.
#pragma once

#include "batten/geometry/frame.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// S(u,v) = C(u) + T(v) − T(start), over the bases of both curves, periodic too, with the products
// of their weights: exact. The profile stays where it is. Throws std::invalid_argument where
// either is a point or both lie on one line. [Piegl & Tiller 1997, §10.4; Farin 2002, §15.5]
NurbsSurface SweepTranslational(const NurbsCurve<3>& profile, const NurbsCurve<3>& trajectory);

// The swung surface S(u,v) = (s·P_x(v)·T_x(u), s·P_x(v)·T_y(u), P_z(v)) in the frame's coordinates:
// the profile P, in the plane of x and axis, goes round the axis along T, in the plane of x and y,
// and is scaled by it; exact, over the bases of both curves with the products of their weights. A
// trajectory that is a circle of radius 1/s makes a surface of revolution. Throws
// std::invalid_argument unless the scale is finite and not zero, where a curve leaves its plane by
// more than 1e-9 of its size, saying by how much, where the trajectory or the profile is on the
// axis throughout, and where the profile crosses the axis twice and the trajectory goes round it by
// more than 180 degrees: the surface would go through itself. [Piegl & Tiller 1997, §10.2]
NurbsSurface Swing(const NurbsCurve<3>& profile,
                   const NurbsCurve<3>& trajectory,
                   const Frame& frame = {},
                   double scale = 1);

}  // namespace batten
