// SPDX-License-Identifier: MIT
#include "batten/geometry/curvature.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace batten {

std::optional<SurfaceCurvature> CurvatureOf(const SurfaceJet& jet) {
  const auto normal = UnitNormal(jet);
  if (!normal) return std::nullopt;
  const double E = jet.du.dot(jet.du), F = jet.du.dot(jet.dv), G = jet.dv.dot(jet.dv);
  const double L = normal->dot(jet.duu), M = normal->dot(jet.duv), N = normal->dot(jet.dvv);
  const double det = E * G - F * F;
  SurfaceCurvature result;
  result.gaussian = (L * N - M * M) / det;
  result.mean = (E * N - 2 * F * M + G * L) / (2 * det);
  const double root = std::sqrt(std::max(0.0, result.mean * result.mean - result.gaussian));
  result.principal_low = result.mean - root;
  result.principal_high = result.mean + root;
  return result;
}

std::optional<CurveCurvature> CurvatureOf(const Eigen::Vector3d& first,
                                          const Eigen::Vector3d& second,
                                          const Eigen::Vector3d& third) {
  const double speed = first.norm();
  if (!(speed > 0)) return std::nullopt;
  const Eigen::Vector3d binormal = first.cross(second);
  const double area = binormal.norm();
  CurveCurvature result{area / (speed * speed * speed), 0};
  if (area > 0) result.torsion = binormal.dot(third) / (area * area);
  return result;
}

}  // namespace batten
