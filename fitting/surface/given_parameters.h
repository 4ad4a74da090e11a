// SPDX-License-Identifier: MIT
// Parameters that came with the points, as the base of a surface.
#pragma once

#include "fitting/surface/surface_preparation.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// A cloud at its own (u, v). Inside, the box of the given parameters is scaled to mean lengths on a
// first coarse fit, so that fairness weighs both directions alike and cells are nearly square
// whatever the units are.
struct GivenParameters {
  PreparedCloud prepared;
  Eigen::Vector2d low, high;  // the box in the user's units

  // A surface over the scaled parameters, over the user's.
  NurbsSurface InUsersUnits(const NurbsSurface& surface) const;
};

// Merges points that agree in place and parameters, measures spacing and noise, flags outliers,
// scales the parameters. Throws std::invalid_argument, with a sentence for the user, where
// parameters are missing or all equal in a direction, or fewer than four different points are not
// on a line.
GivenParameters PrepareGiven(const PointCloud& cloud,
                             const SurfaceFitOptions& options,
                             ThreadPool& pool);

}  // namespace batten::internal
