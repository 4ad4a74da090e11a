// SPDX-License-Identifier: MIT
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "batten/geometry/foot_point.h"
#include "batten/geometry/local_foot_points.h"
#include "geometry/numeric/constants.h"

namespace batten {
using namespace internal;
namespace {

constexpr int kMaxNewtonSteps = 60;
constexpr int kMaxHalvings = 30;

// The moves (du, dv) that keep the parameters in their box.
struct Moves {
  double low_u, high_u, low_v, high_v;
};

// The minimum of g·d + d'Hd/2 over the box for H = (a b; b c) positive definite: inside, or on a
// side that the free minimum violates.
Eigen::Vector2d BoxMinimum(
    double a, double b, double c, const Eigen::Vector2d& g, const Moves& box) {
  const double det = a * c - b * b;
  const double x = (b * g[1] - c * g[0]) / det, y = (b * g[0] - a * g[1]) / det;
  const double side_x = std::clamp(x, box.low_u, box.high_u);
  const double side_y = std::clamp(y, box.low_v, box.high_v);
  if (side_x == x && side_y == y) return {x, y};
  Eigen::Vector2d on_u(side_x, std::clamp(-(g[1] + b * side_x) / c, box.low_v, box.high_v));
  Eigen::Vector2d on_v(std::clamp(-(g[0] + b * side_y) / a, box.low_u, box.high_u), side_y);
  const auto model = [&](const Eigen::Vector2d& d) {
    return g.dot(d) + a * d[0] * d[0] / 2 + b * d[0] * d[1] + c * d[1] * d[1] / 2;
  };
  if (side_y == y) return on_u;
  if (side_x == x) return on_v;
  return model(on_u) <= model(on_v) ? on_u : on_v;
}

// The Newton step for f = |S − q|²/2 within the box, in the parameters that are free; a parameter
// at a side is held when the descent leads out. An indefinite Hessian is shifted by its lowest
// eigenvalue.
Eigen::Vector2d FootStep(const SurfaceJet& jet,
                         const Eigen::Vector3d& difference,
                         bool free_u,
                         bool free_v,
                         const Eigen::Vector2d& gradient,
                         const Moves& box) {
  double a = jet.du.squaredNorm() + difference.dot(jet.duu);
  double b = jet.du.dot(jet.dv) + difference.dot(jet.duv);
  double c = jet.dv.squaredNorm() + difference.dot(jet.dvv);
  const double scale_u = jet.du.squaredNorm(), scale_v = jet.dv.squaredNorm();
  if (!free_u || !free_v) {
    // Uphill curvature: fall back to the positive scale of the first derivatives.
    const double h = free_u ? a : c;
    const double fallback = free_u ? scale_u : scale_v;
    const double curvature = h > 1e-12 * fallback ? h : std::max(fallback, std::abs(h));
    const double g = free_u ? gradient[0] : gradient[1];
    const double step = curvature > 0 ? -g / curvature : 0;
    return free_u ? Eigen::Vector2d(std::clamp(step, box.low_u, box.high_u), 0)
                  : Eigen::Vector2d(0, std::clamp(step, box.low_v, box.high_v));
  }
  // Scale to unit first derivatives, so that the shift means the same in both parameters.
  const double su = scale_u > 0 ? 1 / std::sqrt(scale_u) : 1;
  const double sv = scale_v > 0 ? 1 / std::sqrt(scale_v) : 1;
  a *= su * su;
  b *= su * sv;
  c *= sv * sv;
  const double mean = (a + c) / 2, radius = std::hypot((a - c) / 2, b);
  const double lowest = mean - radius, size = std::max(1.0, std::abs(mean) + radius);
  constexpr double kIndefinite = 1e-9, kLeastCurvature = 1e-3;
  if (lowest < kIndefinite * size) {
    const double shift = kLeastCurvature * size - lowest + std::max(0.0, -lowest);
    a += shift;
    c += shift;
  }
  const Moves scaled{box.low_u / su, box.high_u / su, box.low_v / sv, box.high_v / sv};
  const Eigen::Vector2d step = BoxMinimum(a, b, c, {gradient[0] * su, gradient[1] * sv}, scaled);
  return {step[0] * su, step[1] * sv};
}

ParameterBox DomainOf(const NurbsSurface& surface) {
  return {surface.basis_u().lower(),
          surface.basis_u().upper(),
          surface.basis_v().lower(),
          surface.basis_v().upper()};
}

// `surface` has JetAt.
template <typename Surface>
SurfaceFoot Descend(
    const Surface& surface, const Eigen::Vector3d& q, double u, double v, const ParameterBox& box) {
  u = std::clamp(u, box.u0, box.u1);
  v = std::clamp(v, box.v0, box.v1);
  SurfaceJet jet = surface.JetAt(u, v);
  double value = (jet.point - q).squaredNorm();
  for (int iteration = 0; iteration < kMaxNewtonSteps; ++iteration) {
    const Eigen::Vector3d difference = jet.point - q;
    const Eigen::Vector2d gradient(difference.dot(jet.du), difference.dot(jet.dv));
    const bool free_u = !((u <= box.u0 && gradient[0] >= 0) || (u >= box.u1 && gradient[0] <= 0));
    const bool free_v = !((v <= box.v0 && gradient[1] >= 0) || (v >= box.v1 && gradient[1] <= 0));
    if (!free_u && !free_v) break;
    const Moves moves{box.u0 - u, box.u1 - u, box.v0 - v, box.v1 - v};
    Eigen::Vector2d step = FootStep(jet, difference, free_u, free_v, gradient, moves);
    if (!step.allFinite()) break;  // tangents that are no more than rounding
    bool moved = false;
    for (int halving = 0; halving < kMaxHalvings; ++halving, step *= 0.5) {
      const double nu = std::clamp(u + step[0], box.u0, box.u1);
      const double nv = std::clamp(v + step[1], box.v0, box.v1);
      if (std::abs(nu - u) <= 4 * kEpsilon * (std::abs(u) + box.u1 - box.u0) &&
          std::abs(nv - v) <= 4 * kEpsilon * (std::abs(v) + box.v1 - box.v0)) {
        break;
      }
      const SurfaceJet trial = surface.JetAt(nu, nv);
      const double trial_value = (trial.point - q).squaredNorm();
      if (trial_value < value) {
        moved = value - trial_value > 4 * kEpsilon * value || halving == 0;
        u = nu;
        v = nv;
        jet = trial;
        value = trial_value;
        break;
      }
    }
    if (!moved) break;
  }
  return {u, v, jet.point, std::sqrt(value), 0};
}

}  // namespace

SurfaceFoot LocalFootPoint(const NurbsSurface& surface,
                           const Eigen::Vector3d& q,
                           double u,
                           double v,
                           const ParameterBox& box) {
  return Descend(surface, q, u, v, box);
}

SurfaceFoot LocalFootPoint(const NurbsSurface& surface,
                           const Eigen::Vector3d& q,
                           double u,
                           double v) {
  return Descend(surface, q, u, v, DomainOf(surface));
}

SurfaceFoot LocalFootPoint(const SurfaceEvaluator& surface,
                           const Eigen::Vector3d& q,
                           double u,
                           double v) {
  return Descend(surface, q, u, v, DomainOf(surface.surface()));
}

}  // namespace batten
