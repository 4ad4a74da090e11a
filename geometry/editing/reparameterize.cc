// SPDX-License-Identifier: MIT
#include "batten/geometry/reparameterize.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batten/geometry/clamp.h"
#include "geometry/nurbs/homogeneous.h"
#include "geometry/numeric/number_text.h"
#include "geometry/editing/trim_maps.h"
#include "geometry/numeric/reject.h"

namespace batten {
using namespace internal;
namespace {

// The increasing Möbius map of [lower, upper] onto [a, b] whose derivative falls by the factor
// ratio² from one end to the other. With τ from 0 to 1 across the old domain and σ across the new,
//   σ = ρτ / D,   1 − σ = (1 − τ) / D,   D(τ) = 1 − τ + ρτ.
// In the letters of the header D = (α − γu) / (α − γ·lower), the inverse of the factor of weights.
struct DomainMap {
  const char* function;  // for messages
  double lower, upper, a, b, ratio;

  bool linear() const { return ratio == 1; }
  double Denominator(double u) const {
    if (linear()) return 1;
    return ((upper - u) + ratio * (u - lower)) / (upper - lower);
  }
  double operator()(double u) const {
    const double length = upper - lower, d = Denominator(u);
    if (u - lower < upper - u) return a + (b - a) * (ratio * ((u - lower) / length) / d);
    return b - (b - a) * ((upper - u) / length / d);
  }
};

void CheckMap(const DomainMap& map) {
  if (!std::isfinite(map.a) || !std::isfinite(map.b) || !std::isfinite(map.b - map.a) ||
      !(map.a < map.b)) {
    Reject(
        map.function,
        "the new domain " + IntervalText(map.a, map.b) + " is not an increasing, finite interval");
  }
  if (!(map.ratio > 0) || !std::isfinite(map.ratio)) {
    Reject(map.function,
           "the ratio of the factors at the two ends, " + NumberText(map.ratio) +
               ", is not positive and finite");
  }
}

// Whether every knot, also those outside the domain, lies on the domain's side of the pole.
bool ReachesAllKnots(const DomainMap& map, const SplineBasis& basis) {
  constexpr double kPole = 1e-9;  // nearer to it, outer knots would leave the domain far behind
  return map.Denominator(basis.knots().front()) > kPole * std::min(1.0, map.ratio) &&
         map.Denominator(basis.knots().back()) > kPole * std::min(1.0, map.ratio);
}

std::vector<double> MappedKnots(const DomainMap& map, const SplineBasis& basis) {
  const std::vector<double>& U = basis.knots();
  std::vector<double> V(U.size());
  for (size_t i = 0; i < U.size(); ++i) {
    V[i] = map(U[i]);
    if (U[i] <= map.lower) V[i] = U[i] == map.lower ? map.a : std::min(V[i], map.a);
    if (U[i] >= map.upper) V[i] = U[i] == map.upper ? map.b : std::max(V[i], map.b);
    if (i == 0) continue;
    V[i] = std::max(V[i], V[i - 1]);
    if (V[i] == V[i - 1] && U[i] > U[i - 1] && U[i - 1] >= map.lower && U[i] <= map.upper) {
      Reject(map.function,
             "knots " + NumberText(U[i - 1]) + " and " + NumberText(U[i]) +
                 " would fall together in the new domain " + IntervalText(map.a, map.b));
    }
  }
  return V;
}

// The knots of one round from their images; all others are whole periods away, exactly so where
// they meet the seam.
SplineBasis MappedPeriodicBasis(const DomainMap& map, const SplineBasis& basis) {
  const int p = basis.degree(), round = basis.size() - p;
  std::vector<double> V = MappedKnots(map, basis);
  const int count = static_cast<int>(V.size());
  for (int i = p + round + 1; i < count; ++i) V[i] = map.b + (V[i - round] - map.a);
  for (int i = p - 1; i >= 0; --i) V[i] = map.a - (map.b - V[i + round]);
  return SplineBasis::Periodic(p, std::move(V));
}

SplineBasis MappedBasis(const DomainMap& map, const SplineBasis& basis) {
  if (basis.periodic()) return MappedPeriodicBasis(map, basis);
  return SplineBasis(basis.degree(), MappedKnots(map, basis));
}

// What the weights over a basis are multiplied by: 1 / (D(u_{i+1}) … D(u_{i+p})), from the blossom
// of D^p. [Piegl & Tiller 1997, §6.4]
Eigen::VectorXd WeightFactors(const DomainMap& map, const SplineBasis& basis) {
  Eigen::VectorXd factors = Eigen::VectorXd::Ones(basis.size());
  for (int i = 0; i < basis.size(); ++i) {
    for (int j = 1; j <= basis.degree(); ++j) factors[i] /= map.Denominator(basis.knots()[i + j]);
  }
  if (!factors.allFinite() || !(factors.minCoeff() > 0)) {
    Reject(map.function, "the new weights leave the range of numbers");
  }
  return factors;
}

// Whether the shape has to be clamped before the map is applied to it.
bool NeedsClamping(const DomainMap& map, const SplineBasis& basis) {
  if (map.linear() || basis.clamped()) return false;
  return basis.periodic() || !ReachesAllKnots(map, basis);
}

template <int Dim>
NurbsCurve<Dim> Mapped(const DomainMap& map, const NurbsCurve<Dim>& curve) {
  CheckMap(map);
  if (NeedsClamping(map, curve.basis())) return Mapped(map, Clamped(curve));
  SplineBasis basis = MappedBasis(map, curve.basis());
  if (map.linear()) {
    return NurbsCurve<Dim>(std::move(basis), curve.control_points(), curve.weights());
  }
  return NurbsCurve<Dim>(std::move(basis),
                         curve.control_points(),
                         curve.weights().cwiseProduct(WeightFactors(map, curve.basis())));
}

TrimLoops MappedTrims(const DomainMap& map,
                      const TrimLoops& loops,
                      Direction direction,
                      const SplineBasis& basis) {
  if (map.linear()) return ScaledTrims(loops, direction, basis, map.a, map.b);
  return MobiusTrims(loops, direction, basis, map.a, map.b, map.ratio);
}

NurbsSurface Mapped(const DomainMap& map, const NurbsSurface& surface, Direction direction) {
  CheckMap(map);
  const bool along_u = direction == Direction::kU;
  const SplineBasis& old = BasisOf(surface, direction);
  if (NeedsClamping(map, old)) return Mapped(map, Clamped(surface, direction), direction);
  SplineBasis basis = MappedBasis(map, old);
  Eigen::VectorXd weights = surface.weights();
  if (!map.linear()) {
    const Eigen::VectorXd factors = WeightFactors(map, old);
    for (Eigen::Index k = 0; k < weights.size(); ++k) {
      weights[k] *= factors[along_u ? k / surface.size_v() : k % surface.size_v()];
    }
  }
  return NurbsSurface(along_u ? std::move(basis) : surface.basis_u(),
                      along_u ? surface.basis_v() : std::move(basis),
                      surface.control_points(),
                      std::move(weights))
      .WithTrims(MappedTrims(map, surface.trims(), direction, old));
}

DomainMap LinearMap(const SplineBasis& basis, double a, double b) {
  return {"Reparameterized", basis.lower(), basis.upper(), a, b, 1};
}

DomainMap MobiusMap(const SplineBasis& basis, double al, double be, double ga, double de) {
  const char* const function = "MobiusReparameterized";
  const double largest = std::max({std::abs(al), std::abs(be), std::abs(ga), std::abs(de)});
  if (!std::isfinite(al + be + ga + de) || !std::isfinite(largest) || !(largest > 0)) {
    Reject(function, "the coefficients are all zero or one of them is not finite");
  }
  for (double* c : {&al, &be, &ga, &de}) *c = std::scalbn(*c, -std::ilogb(largest));
  if (!(al * de - be * ga > 0)) {
    Reject(function, "alpha·delta − beta·gamma is not positive");
  }
  const double lower = basis.lower(), upper = basis.upper();
  const double at_lower = al - ga * lower, at_upper = al - ga * upper;
  constexpr double kRounded = 4 * std::numeric_limits<double>::epsilon();
  const bool clear = std::abs(at_lower) > kRounded * (std::abs(al) + std::abs(ga * lower)) &&
                     std::abs(at_upper) > kRounded * (std::abs(al) + std::abs(ga * upper));
  if (!clear || (at_lower > 0) != (at_upper > 0)) {
    Reject(function,
           "the pole u = alpha / gamma = " + NumberText(al / ga) + " lies in the domain " +
               IntervalText(lower, upper));
  }
  return {function,
          lower,
          upper,
          (de * lower - be) / at_lower,
          (de * upper - be) / at_upper,
          at_upper / at_lower};
}

double WeightAt(const SplineBasis& basis, const Eigen::VectorXd& weights, double u) {
  const int p = basis.degree(), span = basis.Span(u);
  Eigen::VectorXd N(p + 1);
  basis.Values(span, u, N.data());
  return N.dot(weights.segment(span - p, p + 1)) / N.sum();
}

}  // namespace

template <int Dim>
NurbsCurve<Dim> Reparameterized(const NurbsCurve<Dim>& curve, double a, double b) {
  return Mapped(LinearMap(curve.basis(), a, b), curve);
}

NurbsSurface Reparameterized(const NurbsSurface& surface, Direction direction, double a, double b) {
  return Mapped(LinearMap(BasisOf(surface, direction), a, b), surface, direction);
}

template <int Dim>
NurbsCurve<Dim> MobiusReparameterized(
    const NurbsCurve<Dim>& curve, double alpha, double beta, double gamma, double delta) {
  return Mapped(MobiusMap(curve.basis(), alpha, beta, gamma, delta), curve);
}

NurbsSurface MobiusReparameterized(const NurbsSurface& surface,
                                   Direction direction,
                                   double alpha,
                                   double beta,
                                   double gamma,
                                   double delta) {
  const DomainMap map = MobiusMap(BasisOf(surface, direction), alpha, beta, gamma, delta);
  return Mapped(map, surface, direction);
}

// The map changes the weight function at the end by 1 / ρ^p against that at the start.
template <int Dim>
NurbsCurve<Dim> WithEndWeights(const NurbsCurve<Dim>& curve, double first, double last) {
  const char* const function = "WithEndWeights";
  for (const double weight : {first, last}) {
    if (std::isfinite(weight) && weight > 0) continue;
    Reject(function, "end weight " + NumberText(weight) + " is not positive and finite");
  }
  const SplineBasis& basis = curve.basis();
  const double start = WeightAt(basis, curve.weights(), basis.lower());
  const double end = basis.periodic() ? start : WeightAt(basis, curve.weights(), basis.upper());
  const double ratio = std::pow(end / start * (first / last), 1.0 / basis.degree());
  const NurbsCurve<Dim> traced =
      Mapped({function, basis.lower(), basis.upper(), basis.lower(), basis.upper(), ratio}, curve);
  const double common = first / WeightAt(traced.basis(), traced.weights(), basis.lower());
  Eigen::VectorXd weights = common * traced.weights();
  if (traced.basis().clamped()) {
    weights[0] = first;
    weights[weights.size() - 1] = last;
  }
  return NurbsCurve<Dim>(traced.basis(), traced.control_points(), std::move(weights));
}

template NurbsCurve<2> Reparameterized(const NurbsCurve<2>&, double, double);
template NurbsCurve<3> Reparameterized(const NurbsCurve<3>&, double, double);
template NurbsCurve<2> MobiusReparameterized(const NurbsCurve<2>&, double, double, double, double);
template NurbsCurve<3> MobiusReparameterized(const NurbsCurve<3>&, double, double, double, double);
template NurbsCurve<2> WithEndWeights(const NurbsCurve<2>&, double, double);
template NurbsCurve<3> WithEndWeights(const NurbsCurve<3>&, double, double);

}  // namespace batten
