// SPDX-License-Identifier: MIT
// Plane loops and trimmed surfaces for laws about trims.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/trim_region.h"
#include "random_splines.h"

namespace batten::internal {

// A circle of four rational arcs, or an ellipse with its axes along u and v.
inline NurbsCurve<2> Ellipse(const Eigen::Vector2d& centre,
                             const Eigen::Vector2d& radii,
                             bool counter_clockwise = true) {
  constexpr int kX[] = {1, 1, 0, -1, -1, -1, 0, 1, 1}, kY[] = {0, 1, 1, 1, 0, -1, -1, -1, 0};
  Eigen::Matrix2Xd points(2, 9);
  Eigen::VectorXd weights(9);
  for (int i = 0; i < 9; ++i) {
    const double y = counter_clockwise ? kY[i] : -kY[i];
    points.col(i) = centre.array() + radii.array() * Eigen::Array2d(kX[i], y);
    weights[i] = i % 2 == 1 ? std::sqrt(0.5) : 1;
  }
  return NurbsCurve<2>(SplineBasis(2, {0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4}), points, weights);
}
inline NurbsCurve<2> Circle(const Eigen::Vector2d& centre, double radius, bool ccw = true) {
  return Ellipse(centre, {radius, radius}, ccw);
}

// A closed polygon through these corners, as a spline of degree 1.
inline NurbsCurve<2> PolygonLoop(const std::vector<Eigen::Vector2d>& corners) {
  const int count = static_cast<int>(corners.size());
  Eigen::Matrix2Xd points(2, count + 1);
  for (int k = 0; k <= count; ++k) points.col(k) = corners[k % count];
  return NurbsCurve<2>(SplineBasis::Uniform(1, count + 1, 0, count), points);
}
inline NurbsCurve<2> RectangleLoop(double u0, double u1, double v0, double v1) {
  return PolygonLoop({{u0, v0}, {u1, v0}, {u1, v1}, {u0, v1}});
}

// A wavy closed cubic whose control points lie about a circle, periodic or clamped, with weights or
// without. It winds once round every place it encloses: control points go round the centre.
inline NurbsCurve<2> WavyLoop(
    RandomSplines& random, const Eigen::Vector2d& centre, double radius, int count, bool rational) {
  constexpr int kDegree = 3;
  Eigen::Matrix2Xd points(2, count + kDegree);
  Eigen::VectorXd weights(count + kDegree);
  for (int k = 0; k < count + kDegree; ++k) {
    if (k >= count) {
      points.col(k) = points.col(k - count);
      weights[k] = weights[k - count];
      continue;
    }
    const double angle = 2 * std::numbers::pi * (k + random.Real(-0.2, 0.2)) / count;
    const double reach = radius * random.Real(0.6, 1);
    points.col(k) = centre + reach * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    weights[k] = rational ? random.Real(0.5, 2) : 1;
  }
  std::vector<double> knots;
  for (int k = -kDegree; k <= count + kDegree; ++k) knots.push_back(k);
  return NurbsCurve<2>(SplineBasis::Periodic(kDegree, knots), points, weights);
}

// The loop moved from the unit square into the surface's domain.
inline NurbsCurve<2> InDomain(const NurbsCurve<2>& loop, const NurbsSurface& surface) {
  const Eigen::Array2d lower(surface.basis_u().lower(), surface.basis_v().lower());
  const Eigen::Array2d upper(surface.basis_u().upper(), surface.basis_v().upper());
  Eigen::Matrix2Xd points = loop.control_points();
  for (auto point : points.colwise()) point = lower + (upper - lower) * point.array();
  return NurbsCurve<2>(loop.basis(), points, loop.weights());
}

inline NurbsSurface Trimmed(const NurbsSurface& surface, std::vector<NurbsCurve<2>> loops) {
  for (NurbsCurve<2>& loop : loops) loop = InDomain(loop, surface);
  return surface.WithTrims(TurnedLoops(std::move(loops)));
}

// Named sets of loops of the unit square: an outer one and holes, or, turned as they are to be,
// those of several regions.
struct LoopCase {
  std::string name;
  std::vector<NurbsCurve<2>> loops;
  bool turned = false;
};
inline NurbsSurface Trimmed(const NurbsSurface& surface, const LoopCase& one) {
  if (!one.turned) return Trimmed(surface, one.loops);
  std::vector<NurbsCurve<2>> loops;
  for (const NurbsCurve<2>& loop : one.loops) loops.push_back(InDomain(loop, surface));
  return surface.WithTrims(std::move(loops));
}

// Two regions beside one another, and a third in the hole of the second.
inline std::vector<NurbsCurve<2>> LoopsOfThreeRegions() {
  return {Circle({0.24, 0.3}, 0.2),
          Circle({0.7, 0.65}, 0.28),
          RectangleLoop(0.62, 0.76, 0.6, 0.68),
          Circle({0.7, 0.65}, 0.18, false),
          Circle({0.3, 0.3}, 0.1, false)};
}

inline std::vector<LoopCase> LoopCases(unsigned seed) {
  RandomSplines random(seed);
  const std::vector<Eigen::Vector2d> ell{{0, 0}, {1, 0}, {1, 0.35}, {0.4, 0.45}, {0.4, 1}, {0, 1}};
  const std::vector<Eigen::Vector2d> comb{{0.05, 0.1},
                                          {0.95, 0.1},
                                          {0.95, 0.9},
                                          {0.75, 0.9},
                                          {0.75, 0.3},
                                          {0.6, 0.3},
                                          {0.6, 0.8},
                                          {0.4, 0.8},
                                          {0.4, 0.3},
                                          {0.25, 0.3},
                                          {0.25, 0.9},
                                          {0.05, 0.9}};
  return {{"disc", {Circle({0.5, 0.5}, 0.4)}},
          {"disc that touches all sides", {Circle({0.5, 0.5}, 0.5)}},
          {"ring", {Circle({0.5, 0.5}, 0.45), Circle({0.5, 0.5}, 0.2, false)}},
          {"ell", {PolygonLoop(ell)}},
          {"comb", {PolygonLoop(comb)}},
          {"square with holes",
           {RectangleLoop(0, 1, 0, 1),
            Circle({0.3, 0.3}, 0.1, false),
            Circle({0.7, 0.35}, 0.15, false),
            RectangleLoop(0.2, 0.6, 0.6, 0.8)}},
          {"wave", {WavyLoop(random, {0.5, 0.5}, 0.48, 9, false)}},
          {"rational waves",
           {WavyLoop(random, {0.5, 0.5}, 0.49, 12, true),
            WavyLoop(random, {0.5, 0.45}, 0.15, 6, true)}},
          {"three regions", LoopsOfThreeRegions(), true}};
}

// Whether a loop is so near that rounding may decide.
inline bool NearLoop(const TrimRegion& region, const NurbsSurface& surface, double u, double v) {
  constexpr double kNear = 1e-9;
  const double a = kNear * (surface.basis_u().upper() - surface.basis_u().lower());
  const double b = kNear * (surface.basis_v().upper() - surface.basis_v().lower());
  return region.CoverOf({u - a, u + a, v - b, v + b}) == TrimRegion::Cover::kCut;
}

}  // namespace batten::internal
