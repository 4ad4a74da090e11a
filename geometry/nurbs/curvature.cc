// SPDX-License-Identifier: MIT
#include "batten/geometry/curvature.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

namespace batten {
namespace {

// The second fundamental form in the orthonormal frame (e, f) of the tangent plane: normal
// curvatures along e and f, and the twist between.
struct TangentForm {
  Eigen::Vector3d e, f;
  double ee, ef, ff;

  double mean() const { return (ee + ff) / 2; }
  double root() const { return std::hypot((ee - ff) / 2, ef); }
};

// With S_u = a e and S_v = b e + c f the frame's form follows from L, M and N step by step. The
// longer tangent is e.
std::optional<TangentForm> FormOf(const SurfaceJet& jet) {
  const auto normal = UnitNormal(jet);
  if (!normal) return std::nullopt;
  const bool turned = jet.dv.squaredNorm() > jet.du.squaredNorm();
  const Eigen::Vector3d &first = turned ? jet.dv : jet.du, &second = turned ? jet.du : jet.dv;
  TangentForm form;
  const double a = first.norm();
  form.e = first / a;
  form.f = normal->cross(form.e);
  const double b = second.dot(form.e), c = second.dot(form.f);
  const double L = normal->dot(turned ? jet.dvv : jet.duu), M = normal->dot(jet.duv);
  const double N = normal->dot(turned ? jet.duu : jet.dvv);
  form.ee = L / a / a;
  form.ef = (M / a - b * form.ee) / c;
  form.ff = ((N / c - b / c * b * form.ee) - 2 * b * form.ef) / c;
  return form;
}

}  // namespace

std::optional<SurfaceCurvature> CurvatureOf(const SurfaceJet& jet) {
  const auto form = FormOf(jet);
  if (!form) return std::nullopt;
  const double mean = form->mean(), root = form->root();
  return SurfaceCurvature{
      form->ee * form->ff - form->ef * form->ef, mean, mean - root, mean + root};
}

// The eigenvector of the greater eigenvalue is at half the angle of (ee − ff, 2 ef).
std::optional<PrincipalDirections> PrincipalDirectionsOf(const SurfaceJet& jet) {
  const auto form = FormOf(jet);
  if (!form) return std::nullopt;
  const double angle = std::atan2(2 * form->ef, form->ee - form->ff) / 2;
  const double c = std::cos(angle), s = std::sin(angle);
  return PrincipalDirections{c * form->f - s * form->e, c * form->e + s * form->f};
}

// In terms of the arc length: T = C′/|C′|, then C″ and C‴ over powers of |C′|, which neither
// overflow nor vanish with the unit of length.
std::optional<CurveCurvature> CurvatureOf(const Eigen::Vector3d& first,
                                          const Eigen::Vector3d& second,
                                          const Eigen::Vector3d& third) {
  const double speed = first.stableNorm();
  if (!(speed > 0)) return std::nullopt;
  const Eigen::Vector3d bend = (first / speed).cross(second / speed / speed);
  CurveCurvature result{bend.norm(), 0};
  if (result.curvature > 0) {
    const Eigen::Vector3d binormal = bend / result.curvature;
    result.torsion = binormal.dot(third / speed / speed / speed) / result.curvature;
  }
  return result;
}

}  // namespace batten
