// SPDX-License-Identifier: MIT
#include "geometry/bezier/normal_limits.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "batten/geometry/curvature.h"
#include "geometry/bezier/limit_series.h"
#include "geometry/bezier/spline_pieces.h"

namespace batten::internal {
namespace {

constexpr double kAgree = 1e-6;
constexpr double kNearEdge = 1e-3;  // of a piece
constexpr int kFewTerms = 4, kMostTerms = 10;

// A place (s,t) in a piece.
struct Place {
  SurfacePiece piece;
  double s, t;
};

// The origin is the nearest corner of the piece, so that collapsed rows differ by nothing.
Place PlaceOf(const NurbsSurface& surface, double u, double v) {
  u = surface.basis_u().Clamp(u);
  v = surface.basis_v().Clamp(v);
  const int span_u = surface.basis_u().Span(u), span_v = surface.basis_v().Span(v);
  const auto part = [](const SplineBasis& basis, int span, double at) {
    const std::vector<double>& U = basis.knots();
    return (at - U[span]) / (U[span + 1] - U[span]);
  };
  const double s = part(surface.basis_u(), span_u, u), t = part(surface.basis_v(), span_v, v);
  return {AboutCorner(surface, span_u, span_v, s < 0.5 ? 0 : 1, t < 0.5 ? 0 : 1), s, t};
}

// The place itself and, nearby, those on the sides of the piece.
std::vector<std::pair<double, double>> Candidates(const Place& place) {
  const auto snapped = [](double x) { return x < kNearEdge ? 0.0 : x > 1 - kNearEdge ? 1.0 : x; };
  const double s = snapped(place.s), t = snapped(place.t);
  std::vector<std::pair<double, double>> candidates{{place.s, place.t}};
  for (const auto& candidate : {std::pair{place.s, t}, {s, place.t}, {s, t}}) {
    if (std::find(candidates.begin(), candidates.end(), candidate) == candidates.end()) {
      candidates.push_back(candidate);
    }
  }
  return candidates;
}

// Directions from (s,t) that stay in the piece, 15° apart, those along the parameter lines first.
std::vector<Eigen::Vector2d> RaysInside(double s, double t) {
  const auto inside = [](double at, double step) {
    return !(at <= 0 && step < 0) && !(at >= 1 && step > 0);
  };
  std::vector<Eigen::Vector2d> rays;
  for (const double x : {0.0,
                         1.0,
                         0.5,
                         0.8660254037844386,
                         0.7071067811865476,
                         0.25881904510252074,
                         0.9659258262890683}) {
    const double y = std::sqrt(1 - x * x);
    for (const double sign_x : {1.0, -1.0}) {
      for (const double sign_y : {1.0, -1.0}) {
        if ((x == 0 && sign_x < 0) || (y == 0 && sign_y < 0)) continue;
        const Eigen::Vector2d ray(sign_x * x, sign_y * y);
        if (inside(s, ray[0]) && inside(t, ray[1])) rays.push_back(ray);
      }
    }
  }
  return rays;
}

VectorSeries NormalSeries(const SurfaceSeries& series, const Eigen::Vector2d& ray) {
  return Cross(series.AlongRay(1, 0, ray[0], ray[1]), series.AlongRay(0, 1, ray[0], ray[1]));
}

double ErrorOf(const VectorSeries& series, int k) {
  return std::max({series.x[k].error, series.y[k].error, series.z[k].error});
}

// What the rays from a place say.
enum class Finding { kRegular, kLimit, kNothing, kContradiction };
struct NormalFound {
  Finding finding = Finding::kNothing;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
};

// The limits must agree to their own accuracy; the most certain one is the answer.
NormalFound CommonNormal(const SurfacePiece& piece, double s, double t, int terms) {
  const SurfaceSeries series(piece, s, t, terms);
  NormalFound found;
  double best = 0;
  std::vector<std::pair<Eigen::Vector3d, double>> limits;
  for (const Eigen::Vector2d& ray : RaysInside(s, t)) {
    const VectorSeries normal = NormalSeries(series, ray);
    const auto order = LeadingOrder(normal);
    if (!order) continue;
    const Eigen::Vector3d limit = normal[*order].normalized();
    if (*order == 0) return {Finding::kRegular, limit};  // the same on all rays
    const double certainty = normal[*order].norm() / ErrorOf(normal, *order);
    limits.push_back({limit, certainty});
    if (certainty > best) {
      best = certainty;
      found = {Finding::kLimit, limit};
    }
  }
  for (const auto& [limit, certainty] : limits) {
    const double allowed = kAgree + 4 / certainty;
    if ((limit - found.normal).norm() > allowed) found.finding = Finding::kContradiction;
  }
  return found;
}

NormalFound CommonNormal(const SurfacePiece& piece, double s, double t) {
  const NormalFound found = CommonNormal(piece, s, t, kFewTerms);
  return found.finding == Finding::kNothing ? CommonNormal(piece, s, t, kMostTerms) : found;
}

// Whether S_u × S_v is so small beside what its factors are made of that it may be rounding.
bool Suspicious(const NurbsSurface& surface, const SurfaceJet& jet) {
  constexpr double kSmall = 1e-9;
  const auto size = [](const Eigen::Vector3d& x) { return x.lpNorm<1>(); };
  const double width_u = surface.basis_u().upper() - surface.basis_u().lower();
  const double width_v = surface.basis_v().upper() - surface.basis_v().lower();
  const double twist = size(jet.duv);
  const double du = size(jet.du) + size(jet.duu) * width_u + twist * width_v;
  const double dv = size(jet.dv) + size(jet.dvv) * width_v + twist * width_u;
  return !(size(jet.du.cross(jet.dv)) > kSmall * du * dv);
}

// Curvatures along one ray, where they have a limit.
std::optional<std::pair<Rounded, Rounded>> CurvatureAlongRay(const SurfaceSeries& series,
                                                             const Eigen::Vector2d& ray,
                                                             int order) {
  const auto along = [&](int i, int j) { return series.AlongRay(i, j, ray[0], ray[1]); };
  const VectorSeries du = along(1, 0), dv = along(0, 1), normal = Cross(du, dv);
  const Series E = Dot(du, du), F = Dot(du, dv), G = Dot(dv, dv);
  const Series L = Dot(normal, along(2, 0)), M = Dot(normal, along(1, 1));
  const Series N = Dot(normal, along(0, 2));
  const double area = normal[order].norm();
  // The limit of series / (|normal| r^order)^power; none where it is infinite.
  const auto limit = [&](const Series& numerator, int power) -> std::optional<Rounded> {
    const auto leading = LeadingOrder(numerator);
    if (leading && *leading < power * order) return std::nullopt;
    const double scale = std::pow(area, power);
    const Rounded& term = numerator[power * order];
    return Rounded{term.value / scale, term.error / scale};
  };
  const auto gaussian = limit(L * N - M * M, 4);
  const auto mean = limit(E * N + G * L - (F * M + F * M), 3);
  if (!gaussian || !mean) return std::nullopt;
  return std::pair{*gaussian, Rounded{mean->value / 2, mean->error / 2}};
}

std::optional<SurfaceCurvature> CommonCurvature(const SurfacePiece& piece, double s, double t) {
  constexpr int kHighestOrder = 2;
  const SurfaceSeries few(piece, s, t, kFewTerms);
  std::optional<std::pair<Rounded, Rounded>> common;
  for (const Eigen::Vector2d& ray : RaysInside(s, t)) {
    const auto order = LeadingOrder(NormalSeries(few, ray));
    if (!order) continue;
    if (*order > kHighestOrder) return std::nullopt;
    const auto found = CurvatureAlongRay(SurfaceSeries(piece, s, t, 4 * *order + 2), ray, *order);
    if (!found) return std::nullopt;
    if (!common) common = found;
    const auto& [gaussian, mean] = *found;
    const double size = std::sqrt(std::abs(common->first.value)) + std::abs(common->second.value);
    if (std::abs(mean.value - common->second.value) > kAgree * size + 4 * mean.error ||
        std::abs(gaussian.value - common->first.value) >
            kAgree * size * size + 4 * gaussian.error) {
      return std::nullopt;
    }
  }
  if (!common) return std::nullopt;
  const auto& [gaussian, mean] = *common;
  const Rounded square = mean * mean - gaussian;
  const double root = square.significant() && square.value > 0 ? std::sqrt(square.value) : 0;
  return SurfaceCurvature{gaussian.value, mean.value, mean.value - root, mean.value + root};
}

}  // namespace

std::optional<Eigen::Vector3d> LimitNormal(const NurbsSurface& surface, double u, double v) {
  const Place place = PlaceOf(surface, u, v);
  for (const auto& [s, t] : Candidates(place)) {
    const NormalFound found = CommonNormal(place.piece, s, t);
    if (found.finding == Finding::kRegular || found.finding == Finding::kLimit) return found.normal;
  }
  return std::nullopt;
}

}  // namespace batten::internal

namespace batten {
using namespace internal;

std::optional<Eigen::Vector3d> NurbsSurface::NormalAt(double u, double v) const {
  const SurfaceJet jet = JetAt(u, v);
  if (Suspicious(*this, jet)) return LimitNormal(*this, u, v);
  return jet.du.cross(jet.dv).stableNormalized();
}

std::optional<SurfaceCurvature> CurvatureAt(const NurbsSurface& surface, double u, double v) {
  const SurfaceJet jet = surface.JetAt(u, v);
  if (!Suspicious(surface, jet)) return CurvatureOf(jet);
  // At distance d from a degenerate edge curvature is lost to ε/d, and off its limit by d.
  constexpr double kAtEdge = 1e-8;
  const Place place = PlaceOf(surface, u, v);
  bool regular = false;
  for (const auto& [s, t] : Candidates(place)) {
    const bool near = std::max(std::abs(s - place.s), std::abs(t - place.t)) < kAtEdge;
    if (regular && !near) break;
    const NormalFound found = CommonNormal(place.piece, s, t);
    regular = regular || found.finding == Finding::kRegular;
    if (found.finding == Finding::kLimit) return CommonCurvature(place.piece, s, t);
  }
  if (regular) return CurvatureOf(JetOf(place.piece, place.s, place.t));
  return std::nullopt;
}

}  // namespace batten
