// SPDX-License-Identifier: MIT
// A clamped surface as OpenCASCADE's, for what is measured beside it.
#pragma once

#include <Geom_BSplineSurface.hxx>

#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

inline Handle(Geom_BSplineSurface) ToOpenCascade(const NurbsSurface& surface) {
  const auto basis = [](const SplineBasis& b, auto& knots, auto& multiplicities) {
    int count = 0;
    for (const double knot : b.knots()) {
      if (count > 0 && knots(count) == knot) {
        ++multiplicities(count);
      } else {
        knots(++count) = knot;
        multiplicities(count) = 1;
      }
    }
  };
  const int n = surface.size_u(), m = surface.size_v();
  const int count_u = static_cast<int>(surface.basis_u().Spans().size()) + 1;
  const int count_v = static_cast<int>(surface.basis_v().Spans().size()) + 1;
  TColStd_Array1OfReal u(1, count_u), v(1, count_v);
  TColStd_Array1OfInteger mu(1, count_u), mv(1, count_v);
  basis(surface.basis_u(), u, mu);
  basis(surface.basis_v(), v, mv);
  TColgp_Array2OfPnt poles(1, n, 1, m);
  TColStd_Array2OfReal weights(1, n, 1, m);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < m; ++j) {
      const Eigen::Vector3d p = surface.control_point(i, j);
      poles(i + 1, j + 1) = gp_Pnt(p.x(), p.y(), p.z());
      weights(i + 1, j + 1) = surface.weights()[i * m + j];
    }
  }
  return new Geom_BSplineSurface(poles, weights, u, v, mu, mv, surface.basis_u().degree(), surface.basis_v().degree());
}

}  // namespace batten::internal
