// SPDX-License-Identifier: MIT
#include "geometry/shapes/translational_surface.h"

#include <stdexcept>
#include <utility>

#include "geometry/editing/deviation_bound.h"
#include "geometry/numeric/number_text.h"

namespace batten::internal {

BezierSurface TranslationalSurface(const BezierCurve<3>& along_u, const BezierCurve<3>& along_v) {
  const int p = along_u.degree(), q = along_v.degree();
  Eigen::Matrix3Xd points(3, (p + 1) * (q + 1));
  Eigen::VectorXd weights(points.cols());
  for (int i = 0; i <= p; ++i) {
    for (int j = 0; j <= q; ++j) {
      const int k = i * (q + 1) + j;
      points.col(k) = along_u.control_points().col(i) +
                      (along_v.control_points().col(j) - along_v.control_points().col(0));
      weights[k] = along_u.weights()[i] * (along_v.weights()[j] / along_v.weights()[0]);
    }
  }
  return BezierSurface(p, q, std::move(points), std::move(weights));
}

std::optional<TranslationalForm> AsTranslational(const BezierSurface& surface, double tolerance) {
  if (!(tolerance >= 0)) {
    throw std::invalid_argument("AsTranslational: tolerance = " + NumberText(tolerance) +
                                " is negative");
  }
  const auto edges = BoundaryCurves(surface);  // u = 0, u = 1, v = 0, v = 1
  const double error = DeviationBound(TranslationalSurface(edges[2], edges[0]), surface);
  if (!(error <= tolerance)) return {};
  return TranslationalForm{edges[2], edges[0], error};
}

}  // namespace batten::internal
