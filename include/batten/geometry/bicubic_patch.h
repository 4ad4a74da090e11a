// SPDX-License-Identifier: MIT
// The bicubic patch of positions, tangents and twists at its corners.
#pragma once

#include <Eigen/Core>
#include <array>

#include "batten/geometry/nurbs_surface.h"

namespace batten {

// Data of a bicubic patch at its corners (u, v) = (0,0), (1,0), (0,1), (1,1), in this order.
struct PatchCorners {
  std::array<Eigen::Vector3d, 4> points, tangents_u, tangents_v;
  std::array<Eigen::Vector3d, 4> twists = {Eigen::Vector3d::Zero(),
                                           Eigen::Vector3d::Zero(),
                                           Eigen::Vector3d::Zero(),
                                           Eigen::Vector3d::Zero()};  // ∂²S/∂u∂v
};

// The bicubic Hermite (Ferguson) patch over [0, 1]² with this position, ∂S/∂u, ∂S/∂v and twist at
// each corner, as one Bézier patch. Exact. Throws std::invalid_argument where a number is not
// finite, and where all points coincide or all control points lie on one line. [Ferguson 1964;
// Farin 2002, §15.5]
NurbsSurface BicubicPatch(const PatchCorners& corners);

}  // namespace batten
