// SPDX-License-Identifier: MIT
// Curves and surfaces that continue others with tangents or curvatures, all freedoms explicit.
#pragma once

#include <Eigen/Core>

#include "batten/geometry/joins.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// R(s) = λ(s) C(φ(s)) in homogeneous coordinates, C run towards the joint and past it, has the
// point, tangent and curvature of C at s = 0 whatever λ and φ are; what counts of them are
//  λ(0) = alpha > 0, the scale of the weights;  φ′(0) = beta > 0, the ratio of the speeds;
//  λ′(0) = eta and λ″(0) = eta2, which change weights alone;  φ″(0) = beta2.
// All of alpha = beta = 1, eta = 0 is C¹ (and C² with beta2 = eta2 = 0) in homogeneous coordinates;
// eta = eta2 = 0 is all there is without weights. [Farin 2002, §12.8; Hohmeyer & Barsky 1989]
struct JoinFreedom {
  double alpha = 1, beta = 1, eta = 0, beta2 = 0, eta2 = 0;
};

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
