// SPDX-License-Identifier: MIT
// Surfaces on which closest points are hard to find.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>

#include "batten/geometry/nurbs_surface.h"
#include "exact_shapes.h"
#include "random_splines.h"

namespace batten::internal {

inline constexpr int kNastyKinds = 18;

inline NurbsSurface WithPoints(const NurbsSurface& surface, Eigen::Matrix3Xd points) {
  return NurbsSurface(surface.basis_u(), surface.basis_v(), std::move(points), surface.weights());
}

// A surface of one of kNastyKinds kinds, turned, sheared and moved at random.
inline NurbsSurface NastySurface(int kind, RandomSplines& random) {
  const auto low = [&] { return random.Integer(1, 5); };
  const auto make = [&]() -> NurbsSurface {
    switch (kind) {
      case 0:  // folded
        return random.Surface(low(), low(), false, {.most_spans = 3});
      case 1:  // weights that differ by 10⁴
        return random.Surface(low(), low(), true, {.most_spans = 3});
      case 2:  // a sheet, as fits are
        return random.Sheet(low(), low(), 1.5, {.most_spans = 8});
      case 3:  // closed in both directions
        return Torus(2, random.Real(0.1, 1.9));
      case 4:  // two collapsed edges
        return Sphere(1);
      case 5: {  // one collapsed edge
        const NurbsSurface whole = random.Surface(low(), low(), random.Coin(), {.most_spans = 3});
        Eigen::Matrix3Xd points = whole.control_points();
        for (int i = 0; i < whole.size_u(); ++i) points.col(i * whole.size_v()) = points.col(0);
        return WithPoints(whole, std::move(points));
      }
      case 6:  // unclamped
        return random.Surface(low(), low(), random.Coin(), {.clamped = false, .most_spans = 3});
      case 7:  // a line of closest points at once
        return random.Coin() ? Cylinder(1, 3) : Cone(1, 2);
      case 8:  // one piece of high degree
        return random.Surface(
            random.Integer(6, 11), random.Integer(6, 11), random.Coin(), {.most_spans = 1});
      case 9:  // creases everywhere
        return random.Surface(1, random.Integer(1, 2), random.Coin(), {.most_spans = 6});
      case 10: {  // long and thin
        const NurbsSurface whole = random.Surface(low(), low(), false, {.most_spans = 4});
        Eigen::Matrix3Xd points = whole.control_points();
        points.row(1) *= 1e-3;
        return WithPoints(whole, std::move(points));
      }
      case 11:  // periodic in one direction or both
        return random.Surface(low(),
                              low(),
                              random.Coin(),
                              {.most_spans = 4, .highest_multiplicity = 2, .periodic = true},
                              {.most_spans = 4, .periodic = random.Coin()});
      case 12: {  // a roll whose turns nearly touch
        SplineBasis u = SplineBasis::Uniform(3, 40, 0, 1), v = SplineBasis::Uniform(2, 4, 0, 1);
        Eigen::Matrix3Xd points(3, u.size() * v.size());
        for (int i = 0; i < u.size(); ++i) {
          const double angle = 20 * u.Greville(i), radius = 0.3 + 1e-3 * angle;
          for (int j = 0; j < v.size(); ++j) {
            points.col(i * v.size() + j) << radius * std::cos(angle), radius * std::sin(angle),
                v.Greville(j);
          }
        }
        return NurbsSurface(std::move(u), std::move(v), std::move(points));
      }
      case 13: {  // coincident control points inside: the surface stands still there
        const NurbsSurface whole = random.Surface(low(), low(), random.Coin(), {.most_spans = 3});
        Eigen::Matrix3Xd points = whole.control_points();
        const int i = whole.size_u() / 2, j = whole.size_v() / 2;
        for (int a = std::max(0, i - 1); a <= std::min(i + 1, whole.size_u() - 1); ++a) {
          for (int b = std::max(0, j - 1); b <= std::min(j + 1, whole.size_v() - 1); ++b) {
            points.col(a * whole.size_v() + b) = points.col(i * whole.size_v() + j);
          }
        }
        return WithPoints(whole, std::move(points));
      }
      case 14: {  // a corner and two of its neighbours fall together
        const NurbsSurface whole = random.Surface(low(), low(), random.Coin(), {.most_spans = 3});
        Eigen::Matrix3Xd points = whole.control_points();
        points.col(1) = points.col(whole.size_v()) = points.col(0);
        return WithPoints(whole, std::move(points));
      }
      case 15: {  // all in one plane, folded over itself
        const NurbsSurface whole = random.Surface(low(), low(), random.Coin(), {.most_spans = 3});
        Eigen::Matrix3Xd points = whole.control_points();
        points.row(2).setZero();
        return WithPoints(whole, std::move(points));
      }
      case 16: {  // all of it one curve, or one point
        const NurbsSurface whole = random.Surface(low(), low(), random.Coin(), {.most_spans = 3});
        Eigen::Matrix3Xd points = whole.control_points();
        const bool curve = random.Coin();
        for (int k = 0; k < whole.size_u() * whole.size_v(); ++k) {
          points.col(k) = points.col(curve ? k - k % whole.size_v() : 0);
        }
        return WithPoints(whole, std::move(points));
      }
      default: {  // the last row of control points is the first
        const NurbsSurface whole = random.Surface(low(), low(), random.Coin(), {.most_spans = 4});
        Eigen::Matrix3Xd points = whole.control_points();
        points.rightCols(whole.size_v()) = points.leftCols(whole.size_v());
        return WithPoints(whole, std::move(points));
      }
    }
  };
  const NurbsSurface surface = make();
  Eigen::Matrix3d map = random.Orthogonal();
  if (random.Coin()) map.col(0) *= random.Logarithmic(0.2, 5);
  return WithPoints(surface, (map * surface.control_points()).colwise() + random.Vector(1));
}

}  // namespace batten::internal
