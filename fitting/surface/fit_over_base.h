// SPDX-License-Identifier: MIT
// The surface fit over a chosen parameterization: inliers, knot grid, solution, joint optimization.
#pragma once

#include "batten/fitting/surface_options.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/surface/surface_measurement.h"
#include "fitting/surface/surface_preparation.h"

namespace batten::internal {

struct FittedState {
  SurfaceState draft;    // in the cloud's local coordinates, over the base's parameters
  PointMask used;        // mask of the prepared points: inliers of the fit
  bool doubted = false;  // outliers were set aside, or a loss the fitter chose bounds them
  FitReport report;      // the given one and all stages; no final measurements
};

// So many control points as options ask for are fairness and nothing else over so few points, and
// take long: throws std::invalid_argument.
void RequireDataFor(const SurfaceFitOptions& options, Eigen::Index points);

// Fits the surface in stages: outlier detection and knot grid selection until the two agree,
// reweighting where there are outliers, refinement where a tolerance is given, else the regularized
// solution, then joint optimization where it pays. `report` holds what preparation found. Throws
// Cancelled when progress stops it before there is a surface.
FittedState FitOverBase(const PreparedCloud& prepared,
                        const SurfaceFitOptions& options,
                        FitReport report,
                        ThreadPool& pool,
                        StageClock& clock);

}  // namespace batten::internal
