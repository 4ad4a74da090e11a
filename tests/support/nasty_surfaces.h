// SPDX-License-Identifier: MIT
// Surfaces on which closest points are hard to find.
#pragma once

#include <Eigen/Core>
#include <utility>

#include "batten/geometry/nurbs_surface.h"
#include "exact_shapes.h"
#include "random_splines.h"

namespace batten {

inline constexpr int kNastyKinds = 12;

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

}  // namespace batten
