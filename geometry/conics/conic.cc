// SPDX-License-Identifier: MIT
#include "batten/geometry/conic.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "geometry/numeric/construction_checks.h"

namespace batten {
using namespace internal;
namespace {

Eigen::Vector3d InSpace(const Eigen::Vector2d& p) { return {p[0], p[1], 0}; }

// λ x² along the first axis and μ y² along the second, |λ| ≥ |μ|; the linear part in those axes.
struct PrincipalForm {
  Eigen::Matrix2d axes;
  Eigen::Vector2d lambda, linear;
  double constant;

  Eigen::Vector2d Back(const Eigen::Vector2d& p) const { return axes * p; }
};

PrincipalForm PrincipalOf(const ImplicitConic& conic) {
  const double mean = (conic.a + conic.c) / 2;
  const double spread = std::hypot((conic.a - conic.c) / 2, conic.b / 2);
  double angle = std::atan2(conic.b, conic.a - conic.c) / 2;  // of the eigenvalue mean + spread
  const double strong = mean >= 0 ? mean + spread : mean - spread;
  if (mean < 0) angle += std::acos(0.0);
  PrincipalForm form;
  form.axes << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  if (conic.b == 0 && (conic.a == conic.c || strong == conic.a)) form.axes.setIdentity();
  if (conic.b == 0 && conic.a != conic.c && strong == conic.c) form.axes << 0, -1, 1, 0;
  const double determinant = conic.a * conic.c - conic.b * conic.b / 4;
  const double other = strong == conic.a ? conic.c : conic.a;
  form.lambda = {strong, conic.b == 0 ? other : determinant / strong};
  form.linear = form.axes.transpose() * Eigen::Vector2d(conic.d, conic.e);
  form.constant = conic.f;
  return form;
}

// λ s² + l s + f = 0 across parallel lines, or a parabola.
ConicLocus WithOneSquare(const PrincipalForm& form, double length, double tolerance) {
  const double lambda = form.lambda[0], across = form.linear[0], along = form.linear[1];
  const Eigen::Vector2d direction = form.axes.col(1);
  if (std::abs(along) > tolerance * std::abs(lambda) * length) {
    const double at_across = -across / (2 * lambda);
    const double at_along = (across * across / (4 * lambda) - form.constant) / along;
    const double sense = along * lambda < 0 ? 1 : -1;
    return ParabolaShape{InSpace(form.Back({at_across, at_along})),
                         InSpace(sense * direction),
                         Eigen::Vector3d::UnitZ(),
                         std::abs(along / (4 * lambda))};
  }
  const double middle = -across / (2 * lambda);
  const double square = middle * middle - form.constant / lambda;  // half the distance, squared
  if (std::abs(square) <= tolerance * length * length) {
    return DoubleLine{form.Back({middle, 0}), direction};
  }
  if (square < 0) return EmptyConic{};
  const double half = std::sqrt(square);
  return ParallelLines{{form.Back({middle - half, 0}), form.Back({middle + half, 0})}, direction};
}

ConicLocus WithCentre(const PrincipalForm& form, double length, double tolerance) {
  const Eigen::Vector2d at = -form.linear.cwiseQuotient(2 * form.lambda);
  const Eigen::Vector2d centre = form.Back(at);
  const double value = form.constant + form.linear.dot(at) / 2;
  const bool same_sign = form.lambda[0] * form.lambda[1] > 0;
  const double size = std::max(length, at.norm());
  if (std::abs(value) <= tolerance * std::abs(form.lambda[0]) * size * size) {
    if (same_sign) return SinglePoint{centre};
    const double slope = std::sqrt(-form.lambda[0] / form.lambda[1]);
    const Eigen::Vector2d up = form.Back({1, slope}), down = form.Back({1, -slope});
    return CrossingLines{centre, {up.normalized(), down.normalized()}};
  }
  const Eigen::Vector2d squares = -value * form.lambda.cwiseInverse();
  if (same_sign && squares[0] < 0) return EmptyConic{};
  const Eigen::Vector2d radii = squares.cwiseAbs().cwiseSqrt();
  if (same_sign &&
      std::abs(form.lambda[0] - form.lambda[1]) <= tolerance * std::abs(form.lambda[0])) {
    return CircleShape{InSpace(centre), Eigen::Vector3d::UnitZ(), radii.mean()};
  }
  const int first = same_sign ? 1 : squares[0] > 0 ? 0 : 1;  // the weaker term's radius is larger
  const Eigen::Vector3d a = InSpace(form.axes.col(first)), b = InSpace(form.axes.col(1 - first));
  if (same_sign) return EllipseShape{InSpace(centre), a, b, radii[first], radii[1 - first]};
  return HyperbolaShape{InSpace(centre), a, b, radii[first], radii[1 - first]};
}

}  // namespace

double ImplicitConic::At(const Eigen::Vector2d& p) const {
  return (a * p[0] + b * p[1] + d) * p[0] + (c * p[1] + e) * p[1] + f;
}

Eigen::Vector2d ImplicitConic::GradientAt(const Eigen::Vector2d& p) const {
  return {2 * a * p[0] + b * p[1] + d, b * p[0] + 2 * c * p[1] + e};
}

Eigen::Matrix3d ImplicitConic::Matrix() const {
  return Eigen::Matrix3d{{a, b / 2, d / 2}, {b / 2, c, e / 2}, {d / 2, e / 2, f}};
}

ImplicitConic ImplicitConic::From(const Eigen::Vector2d& origin) const {
  const Eigen::Vector2d gradient = GradientAt(origin);
  return {a, b, c, gradient[0], gradient[1], At(origin)};
}

ConicLocus ClassifyConic(const ImplicitConic& conic, double tolerance) {
  RequireThat(conic.Matrix().allFinite(), "ClassifyConic", "a coefficient is not finite");
  RequireThat(tolerance >= 0, "ClassifyConic", "tolerance is not a number of at least 0");
  const double largest = conic.Matrix().cwiseAbs().maxCoeff();
  if (largest == 0) return WholePlane{};
  const ImplicitConic unit{conic.a / largest,
                           conic.b / largest,
                           conic.c / largest,
                           conic.d / largest,
                           conic.e / largest,
                           conic.f / largest};
  const Eigen::Vector2d linear(unit.d, unit.e);
  if (unit.a == 0 && unit.b == 0 && unit.c == 0) {
    if (linear.isZero(0)) return EmptyConic{};
    const Eigen::Vector2d normal = linear.normalized();
    return LineShape{InSpace(-unit.f / linear.norm() * normal),
                     InSpace(Eigen::Vector2d(-normal[1], normal[0]))};
  }
  const PrincipalForm form = PrincipalOf(unit);
  const double strong = std::abs(form.lambda[0]);
  const double length = std::max(linear.norm() / strong, std::sqrt(std::abs(unit.f) / strong));
  if (std::abs(form.lambda[1]) <= tolerance * strong) return WithOneSquare(form, length, tolerance);
  return WithCentre(form, length, tolerance);
}

std::string NameOf(const ConicLocus& locus) {
  constexpr std::array names = {"circle",
                                "ellipse",
                                "parabola",
                                "hyperbola",
                                "two crossing lines",
                                "two parallel lines",
                                "a double line",
                                "line",
                                "a point",
                                "empty",
                                "the whole plane"};
  static_assert(names.size() == std::variant_size_v<ConicLocus>);
  return names[locus.index()];
}

}  // namespace batten
