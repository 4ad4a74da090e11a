// SPDX-License-Identifier: MIT
// A plane, sphere, cylinder, cone or torus through some points of a cloud, and whether they reject
// it.
#pragma once

#include <optional>
#include <vector>

#include "batten/geometry/thread_pool.h"
#include "fitting/primitives/fitted_surface.h"
#include "fitting/regions/region_points.h"

namespace batten::internal {

// Distances up to so many standard deviations are noise: one normal error in two thousand is
// larger.
inline constexpr double kFarFromShape = 3.5;

// The shape of this kind that most of the points lie on to within `sigma`, from closed formulas
// over the points and their normals, or from `before` where it is given. None where no start is a
// surface. At most some hundreds of points count.
std::optional<FittedSurface> ShapeThrough(const RegionPoints& data,
                                          const std::vector<int>& members,
                                          SurfaceKind kind,
                                          double sigma,
                                          const FittedSurface* before = nullptr);

// How the members lie about a shape.
struct ShapeTest {
  double rms = 0;  // robust: distances beyond 3.5 σ count as that large
  bool passed = false;
};

// Passed: rms ≤ 1.15 σ, chance of few points allowed for, and distances of neighbours are not
// alike.
ShapeTest TestShape(const RegionPoints& data,
                    const std::vector<int>& members,
                    const FittedSurface& shape,
                    double sigma);

// The sine of the angle between a point's normal and the shape's at its foot; 0 without a normal.
double NormalOff(const RegionPoints& data, int point, const FittedSurface& shape);

}  // namespace batten::internal
