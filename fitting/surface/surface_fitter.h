// SPDX-License-Identifier: MIT
// A surface over a base that has been found: who counts, how many cells, the solution, the joint
// stage.
#pragma once

#include "batten/fitting/surface_options.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/surface/surface_measurement.h"
#include "fitting/surface/surface_preparation.h"

namespace batten::internal {

struct FittedState {
  SurfaceState draft;              // in the cloud's local coordinates, over the base's parameters
  PointMask used;                  // of the prepared points: those the fit rests on
  double empty_area_fraction = 0;  // of the domain: no points there
  bool doubted = false;  // points were set aside, or bounded by a loss of the fitter's own choice
  FitReport report;      // the one given and all but what is measured on the finished surface
};

// Stage by stage: outliers told apart and cells chosen until the two agree, reweighting where there
// are outliers, refinement where a tolerance asks for it, else the regularized solution, then the joint
// stage where it pays. `report` says what preparation found. Throws Cancelled when progress stops
// it before there is a surface.
FittedState FitOverBase(const PreparedCloud& prepared,
                        const SurfaceFitOptions& options,
                        FitReport report,
                        ThreadPool& pool);

}  // namespace batten::internal
