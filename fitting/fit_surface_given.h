// SPDX-License-Identifier: MIT
// A surface at parameters that came with the points. Internal: the road FitSurface takes when asked
// for given parameters.
#pragma once

#include "batten/fitting/fit_surface.h"

namespace batten {

// Least squares at the cloud's own (u, v), with everything else FitSurface does: outliers, the grid
// by cross-validation, fairness, reweighting, a tolerance, the joint stage. The domain is the box
// of the given parameters, knots are in their units. Inside, parameters are scaled to mean lengths
// on a first coarse fit, so that fairness weighs both directions alike and cells are nearly square
// whatever the units are. The report's parameter_error holds the distances at the given parameters,
// unless the joint stage has freed those. Throws std::invalid_argument, with a sentence for the
// user, where parameters are missing or all equal in a direction, or fewer than four different
// points are not on a line.
SurfaceFit FitSurfaceAtParameters(const PointCloud& cloud, const SurfaceFitOptions& options);

}  // namespace batten
