// SPDX-License-Identifier: MIT
// Coons parameterization: a base's parameters mapped to the rectangle between four sides, which are
// given curves or the outline of the points.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "batten/fitting/point_mask.h"
#include "batten/geometry/joins.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/constraints/boundary_curves.h"
#include "fitting/outline/four_sided_map.h"
#include "fitting/parameterization/parameterization.h"

namespace batten::internal {

// A side as an edge of the surface: its curve runs in the direction of the rising parameter, over
// [0, length_u] or [0, length_v].
struct PlacedBoundary {
  SurfaceEdge edge;
  BoundaryEdge side;
};

// A given side with the base's parameters of its samples.
struct PlacedSide {
  BoundaryEdge side;
  Eigen::VectorXd parameters;  // of the samples, on its curve
  Eigen::Matrix2Xd places;
};

struct PlacedBoundaries {
  std::vector<PlacedBoundary> sides;
  Eigen::Index beyond = 0;  // points beyond a given side, no longer reached
  std::vector<std::string> warnings;
};

// Reparameterizes the base so that the given sides are edges of its rectangle. `points` are those
// of its parameters, `reached` marks those with a place; points beyond given sides lose theirs.
// Throws std::invalid_argument, with a sentence for the user, where neighbouring sides do not meet
// (it names the gap), two sides claim one edge, or the region between the sides cannot be mapped to
// a rectangle.
PlacedBoundaries ParameterizeByCoons(Parameterization& base,
                                     PointMask& reached,
                                     const Eigen::Matrix3Xd& points,
                                     const std::vector<PlacedSide>& given,
                                     double spacing,
                                     double noise,
                                     ThreadPool& pool);

// Reparameterizes the base of a sheet so that the outline of the points becomes its rectangle,
// where the outline has four corners and slightly bent sides. Returns whether it did.
bool ParameterizeByOutline(Parameterization& base,
                           const PointMask& reached,
                           double spacing,
                           double noise,
                           ThreadPool& pool);

}  // namespace batten::internal
