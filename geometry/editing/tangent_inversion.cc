// SPDX-License-Identifier: MIT
#include "batten/geometry/tangent_inversion.h"

#include <Eigen/QR>
#include <stdexcept>

namespace batten {
using namespace internal;

std::optional<TangentInversion> InvertTangent(const SurfaceJet& jet,
                                              const Eigen::Vector3d& tangent) {
  if (!tangent.allFinite()) {
    throw std::invalid_argument("InvertTangent: the tangent vector is not finite");
  }
  if (!UnitNormal(jet)) return std::nullopt;
  const double length_u = jet.du.stableNorm(), length_v = jet.dv.stableNorm();
  Eigen::Matrix<double, 3, 2> directions;
  directions << jet.du / length_u, jet.dv / length_v;
  const Eigen::Vector2d x = directions.householderQr().solve(tangent);
  return TangentInversion{
      x[0] / length_u, x[1] / length_v, (directions * x - tangent).stableNorm()};
}

std::optional<TangentInversion> InvertTangent(const NurbsSurface& surface,
                                              double u,
                                              double v,
                                              const Eigen::Vector3d& tangent) {
  return InvertTangent(surface.JetAt(u, v), tangent);
}

}  // namespace batten
