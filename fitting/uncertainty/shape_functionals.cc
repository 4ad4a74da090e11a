// SPDX-License-Identifier: MIT
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "batten/fitting/uncertainty.h"

namespace batten {
namespace {

constexpr double kStencil = 1e-3;  // of the knot cell: differences of splines of low degree

// Steps h, and a middle for differences at m − h, m, m + h, all inside the knot cell of a
// parameter.
struct Stencil {
  double middle, step;

  Stencil(const SplineBasis& basis, double parameter) {
    const double at = basis.Clamp(parameter);
    const auto span = static_cast<size_t>(basis.Span(at));
    const double low = basis.knots()[span], high = basis.knots()[span + 1];
    step = kStencil * (high - low);
    middle = std::clamp(at, low + step, high - step);
  }
};

// Adds factor · ∂^(k+l) ν / ∂u^k ∂v^l, k + l ≤ 2.
class Derivatives {
 public:
  Derivatives(const SplineBasis& u, const SplineBasis* v, double at_u, double at_v)
      : u_(u, at_u), at_u_(at_u), at_v_(at_v) {
    if (v) v_.emplace(*v, at_v);
  }

  void Add(int k, int l, double factor) {
    if (factor == 0) return;
    if (k == 0 && l == 0) return Place(at_u_, at_v_, factor);
    const double hu = u_.step, hv = v_ ? v_->step : 1;
    const double u = u_.middle, v = v_ ? v_->middle : at_v_;
    if (k == 1 && l == 1) {
      for (const int a : {-1, 1})
        for (const int b : {-1, 1}) Place(u + a * hu, v + b * hv, a * b * factor / (4 * hu * hv));
      return;
    }
    const double h = k > 0 ? hu : hv, du = k > 0 ? hu : 0, dv = k > 0 ? 0 : hv;
    if (k + l == 1) {
      Place(u + du, v + dv, factor / (2 * h));
      Place(u - du, v - dv, -factor / (2 * h));
      return;
    }
    Place(u + du, v + dv, factor / (h * h));
    Place(u, v, -2 * factor / (h * h));
    Place(u - du, v - dv, factor / (h * h));
  }

  ShapeFunctional Take() { return std::move(terms_); }

 private:
  void Place(double u, double v, double factor) { terms_.push_back({u, v, factor}); }

  Stencil u_;
  std::optional<Stencil> v_;
  double at_u_, at_v_;
  ShapeFunctional terms_;
};

Eigen::Vector3d NormalOf(const NurbsSurface& surface, double u, double v) {
  const auto normal = surface.NormalAt(u, v);
  if (normal) return *normal;
  throw std::invalid_argument("Uncertainty: (u, v): the surface has no normal at (" +
                              std::to_string(u) + ", " + std::to_string(v) + ")");
}

// A regular place of a surface: its jet, normal, and the inverse of its first form.
struct RegularPlace {
  SurfaceJet jet;
  Eigen::Vector3d normal;
  Eigen::Matrix2d first, inverse, second;

  RegularPlace(const NurbsSurface& surface, double u, double v)
      : jet(surface.JetAt(u, v)), normal(NormalOf(surface, u, v)) {
    first << jet.du.dot(jet.du), jet.du.dot(jet.dv), jet.du.dot(jet.dv), jet.dv.dot(jet.dv);
    second << normal.dot(jet.duu), normal.dot(jet.duv), normal.dot(jet.duv), normal.dot(jet.dvv);
    if (!(first.determinant() > 0)) {
      throw std::invalid_argument(
          "Uncertainty: (u, v): the surface has no tangent plane in its parameters there");
    }
    inverse = first.inverse();
  }

  // ξ with the vector's tangential part ξ_u S_u + ξ_v S_v.
  Eigen::Vector2d Components(const Eigen::Vector3d& vector) const {
    return inverse * Eigen::Vector2d(jet.du.dot(vector), jet.dv.dot(vector));
  }
};

}  // namespace

ShapeFunctional PositionAlong(const NurbsSurface& surface,
                              double u,
                              double v,
                              const Eigen::Vector3d& direction) {
  return {{u, v, NormalOf(surface, u, v).dot(direction)}};
}

ShapeFunctional DistanceBetween(const NurbsSurface& surface,
                                const Eigen::Vector2d& first,
                                const Eigen::Vector2d& second) {
  const Eigen::Vector3d across = surface.At(second[0], second[1]) - surface.At(first[0], first[1]);
  if (!(across.norm() > 0))
    throw std::invalid_argument("Uncertainty: second: must be another place than the first");
  const Eigen::Vector3d along = across.normalized();
  return {{first[0], first[1], -NormalOf(surface, first[0], first[1]).dot(along)},
          {second[0], second[1], NormalOf(surface, second[0], second[1]).dot(along)}};
}

// δn = −grad ν, whose component along d is g^ab ν_a S_b·d. [do Carmo 1976, §2.8]
ShapeFunctional NormalAlong(const NurbsSurface& surface,
                            double u,
                            double v,
                            const Eigen::Vector3d& direction) {
  const RegularPlace place(surface, u, v);
  const Eigen::Vector2d to = place.Components(direction);
  Derivatives terms(surface.basis_u(), &surface.basis_v(), u, v);
  terms.Add(1, 0, -to[0]);
  terms.Add(0, 1, -to[1]);
  return terms.Take();
}

// With t = a S_u + b S_v, κ = II(t,t)/I(t,t): δII = Hess ν − ν III and δI = −2ν II, so
// δκ = (Hess ν(t,t) − ν III(t,t) + 2κν II(t,t)) / I(t,t); III = II I⁻¹ II, Hess ν = ν_ab − Γ^c_ab
// ν_c. [Huisken & Polden 1999, §3]
ShapeFunctional NormalCurvature(const NurbsSurface& surface,
                                double u,
                                double v,
                                const Eigen::Vector2d& along) {
  const RegularPlace place(surface, u, v);
  const double length = along.dot(place.first * along);
  if (!(length > 0)) throw std::invalid_argument("NormalCurvature: along: must not be zero");
  const double bend = along.dot(place.second * along), kappa = bend / length;
  const double third = along.dot(place.second * place.inverse * place.second * along);
  const double a = along[0], b = along[1];
  const Eigen::Vector2d turn =
      place.Components(a * a * place.jet.duu + 2 * a * b * place.jet.duv + b * b * place.jet.dvv);
  Derivatives terms(surface.basis_u(), &surface.basis_v(), u, v);
  terms.Add(2, 0, a * a / length);
  terms.Add(1, 1, 2 * a * b / length);
  terms.Add(0, 2, b * b / length);
  terms.Add(1, 0, -turn[0] / length);
  terms.Add(0, 1, -turn[1] / length);
  terms.Add(0, 0, (2 * kappa * bend - third) / length);
  return terms.Take();
}

ShapeFunctional CurvatureRadius(const NurbsSurface& surface,
                                double u,
                                double v,
                                const Eigen::Vector2d& along) {
  const RegularPlace place(surface, u, v);
  const double kappa = along.dot(place.second * along) / along.dot(place.first * along);
  if (kappa == 0) throw std::invalid_argument("CurvatureRadius: along: the surface is flat there");
  ShapeFunctional terms = NormalCurvature(surface, u, v, along);
  for (DisplacementTerm& term : terms) term.factor *= -1 / (kappa * kappa);
  return terms;
}

// δκ = ν_ss + κ² ν, s the arc length.
ShapeFunctional Curvature(const NurbsCurve<2>& curve, double u) {
  const auto jet = curve.Derivatives(u, 2);
  const Eigen::Vector2d first = jet.col(1), second = jet.col(2);
  const double speed = first.norm();
  if (!(speed > 0)) throw std::invalid_argument("Curvature: u: the curve has no tangent there");
  const double kappa = (first[0] * second[1] - first[1] * second[0]) / std::pow(speed, 3);
  Derivatives terms(curve.basis(), nullptr, u, 0);
  terms.Add(2, 0, 1 / (speed * speed));
  terms.Add(1, 0, -first.dot(second) / std::pow(speed, 4));
  terms.Add(0, 0, kappa * kappa);
  return terms.Take();
}

}  // namespace batten
