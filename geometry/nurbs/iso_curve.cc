// SPDX-License-Identifier: MIT
#include "batten/geometry/iso_curve.h"

#include <utility>

#include "geometry/nurbs/checked_parameter.h"
#include "geometry/nurbs/homogeneous.h"

namespace batten {
using namespace internal;

NurbsCurve<3> IsoCurve(const NurbsSurface& surface, Direction direction, double parameter) {
  const bool fix_u = direction == Direction::kU;
  const SplineBasis& fixed = BasisOf(surface, direction);
  const SplineBasis& along = fix_u ? surface.basis_v() : surface.basis_u();
  const double t = CheckedParameter(fixed, parameter, "IsoCurve", fix_u ? "u" : "v");
  const int p = fixed.degree(), span = fixed.Span(t);
  Eigen::VectorXd N(p + 1);
  fixed.Values(span, t, N.data());
  N /= N.sum();  // exactly one where a single function is not zero
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, along.size());
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(along.size());
  const int round = along.periodic() ? along.size() - along.degree() : along.size();
  for (int j = 0; j < along.size(); ++j) {
    if (j >= round) {
      points.col(j) = points.col(j - round);
      weights[j] = weights[j - round];
      continue;
    }
    Eigen::VectorXd c = N;
    const auto column = [&](int r) {
      const Eigen::Index i = span - p + r;
      return fix_u ? i * surface.size_v() + j : j * Eigen::Index{surface.size_v()} + i;
    };
    if (surface.rational()) {
      for (int r = 0; r <= p; ++r) c[r] *= surface.weights()[column(r)];
      weights[j] = c.sum();
      c /= weights[j];
    }
    for (int r = 0; r <= p; ++r) points.col(j) += c[r] * surface.control_points().col(column(r));
  }
  return NurbsCurve<3>(along, std::move(points), std::move(weights));
}

std::array<NurbsCurve<3>, 4> BoundaryCurves(const NurbsSurface& surface) {
  const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
  return {IsoCurve(surface, Direction::kU, u.lower()),
          IsoCurve(surface, Direction::kU, u.upper()),
          IsoCurve(surface, Direction::kV, v.lower()),
          IsoCurve(surface, Direction::kV, v.upper())};
}

}  // namespace batten
