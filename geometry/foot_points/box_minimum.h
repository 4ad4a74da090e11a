// SPDX-License-Identifier: MIT
// The least value of a convex quadratic in two variables over a box. Internal to the search for
// closest points, and inlined into functions compiled for several instruction sets.
#pragma once

#include "geometry/numeric/run_time_dispatch.h"

namespace batten::internal {

// A box of two variables.
struct LocalBox {
  double x0, x1, y0, y1;
};

BATTEN_INLINE double ClampTo(double x, double low, double high) {
  return x < low ? low : x > high ? high : x;
}

// The minimum (dx, dy) of g·d + d'Hd/2 over the box for H = (a b; b c) positive definite: inside,
// or on a side that the free minimum violates.
BATTEN_INLINE void BoxMinimum(double a,
                              double b,
                              double c,
                              double gx,
                              double gy,
                              const LocalBox& box,
                              double* dx,
                              double* dy) {
  const double det = a * c - b * b;
  const double x = (b * gy - c * gx) / det, y = (b * gx - a * gy) / det;
  const double side_x = ClampTo(x, box.x0, box.x1), side_y = ClampTo(y, box.y0, box.y1);
  *dx = x;
  *dy = y;
  if (side_x == x && side_y == y) return;
  const double free_y = ClampTo(-(gy + b * side_x) / c, box.y0, box.y1);
  const double free_x = ClampTo(-(gx + b * side_y) / a, box.x0, box.x1);
  const auto model = [&](double s, double t) {
    return gx * s + gy * t + a * s * s / 2 + b * s * t + c * t * t / 2;
  };
  const bool on_x = side_y == y || (side_x != x && model(side_x, free_y) <= model(free_x, side_y));
  *dx = on_x ? side_x : free_x;
  *dy = on_x ? free_y : side_y;
}

}  // namespace batten::internal
