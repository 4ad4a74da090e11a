// SPDX-License-Identifier: MIT
// A parameterization taken from the (u, v) given with the points.
#pragma once

#include "batten/geometry/nurbs_surface.h"
#include "fitting/surface/surface_preparation.h"

namespace batten::internal {

// A cloud parameterized by its own (u, v). Internally the box of the given parameters is scaled to
// mean lengths on a first coarse fit, so that fairness weighs both directions alike and cells are
// nearly square in any units.
struct GivenParameters {
  PreparedCloud prepared;
  Eigen::Vector2d low, high;  // the box in the user's units

  // Reparameterizes a surface from the scaled parameters to the user's.
  NurbsSurface InUsersUnits(const NurbsSurface& surface) const;
};

// Merges points that agree in place and parameters, measures spacing and noise, flags outliers,
// scales the parameters. Throws std::invalid_argument, with a sentence for the user, where
// parameters are missing or all equal in a direction, or fewer than four different points are not
// on a line.
GivenParameters PrepareGiven(const PointCloud& cloud,
                             const SurfaceFitOptions& options,
                             ThreadPool& pool,
                             StageClock& clock);

}  // namespace batten::internal
