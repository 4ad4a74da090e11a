// SPDX-License-Identifier: MIT
// A base's parameters laid onto the rectangle between four sides: curves the edges are given, and
// the outline of the points for the others.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "batten/fitting/point_mask.h"
#include "fitting/outline/four_sided_map.h"
#include "fitting/constraints/given_sides.h"
#include "fitting/parameterization/surface_base.h"
#include "batten/geometry/joins.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// A side as an edge of the surface: its curve runs in the direction of the rising parameter, over
// [0, length_u] or [0, length_v].
struct LaidSide {
  SurfaceEdge edge;
  GivenSide side;
};

// A given side and where its samples are in the base's parameters.
struct PlacedSide {
  GivenSide side;
  Eigen::VectorXd parameters;  // of the samples, on its curve
  Eigen::Matrix2Xd places;
};

struct LaidSides {
  std::vector<LaidSide> sides;
  Eigen::Index beyond = 0;  // points on the far side of a given one, not reached any more
  std::vector<std::string> warnings;
};

// Changes the base so that its rectangle ends in the given sides. `points` are those of its
// parameters, `reached` those with a place; outside given sides they lose it. Throws
// std::invalid_argument, with a sentence for the user, where neighbouring sides do not meet (the
// gap), two want one edge, or the region between the sides cannot be laid onto a rectangle.
LaidSides LayBetweenSides(SurfaceBase& base,
                          PointMask& reached,
                          const Eigen::Matrix3Xd& points,
                          const std::vector<PlacedSide>& given,
                          double spacing,
                          double noise,
                          ThreadPool& pool);

// Changes the base of a sheet so that its rectangle ends in the outline of the points where that is
// nearly a rectangle: four corners and sides that bend a little. Returns whether it did.
bool LayBetweenOutline(
    SurfaceBase& base, const PointMask& reached, double spacing, double noise, ThreadPool& pool);

}  // namespace batten::internal
