// SPDX-License-Identifier: MIT
// Curves and surfaces that continue others with tangents or curvatures, all freedoms explicit.
#pragma once

#include <Eigen/Core>

#include "batten/geometry/join_freedom.h"
#include "batten/geometry/joins.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// The Bézier curve on [0, 1] of degree order + 1 that continues the upper or lower end of a curve
// with G1 (order 1) or G2 (order 2) and ends at `to` with the weight `to_weight`. It begins where
// the curve ends. Throws std::invalid_argument unless order is 1 or 2, alpha, beta and the weight
// are positive, all is finite, and the weights that come out are positive (the message names the
// one that is not, and what to change). O(p²).
template <int Dim>
NurbsCurve<Dim> Continued(const NurbsCurve<Dim>& curve,
                          bool upper,
                          int order,
                          const Eigen::Matrix<double, Dim, 1>& to,
                          const JoinFreedom& freedom = {},
                          double to_weight = 1);

// The strip across an edge of a surface, in u from 0 at the edge to 1, v along it over the
// surface's own basis; its far edge is the near one shifted by `shift`. The same freedom everywhere
// along the edge, so the joint is G1 or G2 along all of it. Throws as above, and where the surface
// is trimmed or the edge a single point.
NurbsSurface Continued(const NurbsSurface& surface,
                       const SurfaceEdge& edge,
                       int order,
                       const Eigen::Vector3d& shift,
                       const JoinFreedom& freedom = {});

}  // namespace batten
