// SPDX-License-Identifier: MIT
// Surfaces that are height fields over a plane base.
#pragma once

#include <Eigen/Core>

#include "fitting/parameterization/plane_base.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// Returns the surface whose parameters are the plane's coordinates and whose control points lie
// `heights` (1 × n_u·n_v) above their Greville abscissae. A B-spline reproduces the plane's
// coordinates exactly, so such a surface cannot fold.
inline NurbsSurface HeightSurface(const PlaneBase& base,
                                  const SplineBasis& basis_u,
                                  const SplineBasis& basis_v,
                                  const Eigen::MatrixXd& heights) {
  Eigen::Matrix3Xd net(3, heights.cols());
  for (int i = 0; i < basis_u.size(); ++i) {
    for (int j = 0; j < basis_v.size(); ++j) {
      const Eigen::Index k = Eigen::Index{i} * basis_v.size() + j;
      net.col(k) << basis_u.Greville(i), basis_v.Greville(j), heights(0, k);
    }
  }
  net = (base.axes * net).colwise() + base.origin;
  return NurbsSurface(basis_u, basis_v, std::move(net));
}

}  // namespace batten::internal
