// SPDX-License-Identifier: MIT
// Curvature of curves and surfaces from their derivatives.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "batten/geometry/nurbs_surface.h"

namespace batten {

// With n = S_u × S_v / |S_u × S_v|; principal curvatures in increasing order.
struct SurfaceCurvature {
  double gaussian, mean, principal_low, principal_high;
};

// From the first and second fundamental forms; none where the surface has no normal.
// [do Carmo 1976, §3.3]
std::optional<SurfaceCurvature> CurvatureOf(const SurfaceJet& jet);

struct CurveCurvature {
  double curvature;
  double torsion;  // zero for planar curves and where the curvature vanishes
};

// From the first, second and third derivative (a plane curve has z = 0); the curvature is not
// negative. None where the first derivative vanishes.
std::optional<CurveCurvature> CurvatureOf(const Eigen::Vector3d& first,
                                          const Eigen::Vector3d& second,
                                          const Eigen::Vector3d& third);

}  // namespace batten
