// SPDX-License-Identifier: MIT
// A base's parameters laid onto the rectangle between four sides: curves the edges are given, and
// the outline of the points for the others.
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

// A given side and where its samples are in the base's parameters.
struct PlacedSide {
  BoundaryEdge side;
  Eigen::VectorXd parameters;  // of the samples, on its curve
  Eigen::Matrix2Xd places;
};

struct PlacedBoundaries {
  std::vector<PlacedBoundary> sides;
  Eigen::Index beyond = 0;  // points on the far side of a given one, not reached any more
  std::vector<std::string> warnings;
};

// Changes the base so that its rectangle ends in the given sides. `points` are those of its
// parameters, `reached` those with a place; outside given sides they lose it. Throws
// std::invalid_argument, with a sentence for the user, where neighbouring sides do not meet (the
// gap), two want one edge, or the region between the sides cannot be laid onto a rectangle.
PlacedBoundaries ParameterizeByCoons(Parameterization& base,
                                     PointMask& reached,
                                     const Eigen::Matrix3Xd& points,
                                     const std::vector<PlacedSide>& given,
                                     double spacing,
                                     double noise,
                                     ThreadPool& pool);

// Changes the base of a sheet so that its rectangle ends in the outline of the points where that is
// nearly a rectangle: four corners and sides that bend a little. Returns whether it did.
bool ParameterizeByOutline(Parameterization& base,
                           const PointMask& reached,
                           double spacing,
                           double noise,
                           ThreadPool& pool);

}  // namespace batten::internal
