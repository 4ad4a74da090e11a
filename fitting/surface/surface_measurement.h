// SPDX-License-Identifier: MIT
// The last stages of every surface fit: joint optimization where it pays, and the fit report.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "batten/fitting/poles.h"
#include "batten/fitting/surface_options.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/core/stage_clock.h"

namespace batten::internal {

// A fitted surface with its inliers, before the common last stages.
struct SurfaceState {
  NurbsSurface surface;          // in the cloud's local coordinates, parameters in lengths
  PointCloud used;               // the inliers
  Eigen::Matrix2Xd parameters;   // of those, to start from
  Eigen::VectorXd weights;       // of those; empty: ones
  Poles poles;                   // of the surface
  bool robust = false;           // losses bound residuals
  bool noise_is_shared = false;  // noise correlated between neighbours: no excess over local noise
  FitEstimator estimator = {};   // how it was found
};

// Runs the joint optimization of the draft with the variables the options free; where they leave it
// open, only where it pays: residuals are above the noise and there are points enough for free
// parameters. Fills report.optimize. `held`, asked only then, is OptimizeOptions::held of the used
// points.
void OptimiseWhereItPays(SurfaceState& draft,
                         const SurfaceFitOptions& options,
                         const std::function<std::vector<std::uint8_t>()>& held,
                         ThreadPool& pool,
                         StageClock& clock,
                         FitReport& report);

// The fit with its report, measured on the returned surface, rounding of far coordinates included.
// `surface` is in the cloud's local coordinates, `merged` the cloud's distinct points, `used` the
// inliers among them; `shape`, such as "a smooth surface", names what the data are not in a
// warning. With `start` (parameters of the merged points near their foot points) foot points are
// the local ones reached from there, never nearer than the global ones. With `near` (parameters of
// the used points in their order) the search for global foot points starts there: the same result,
// sooner.
SurfaceFit MeasureFit(const NurbsSurface& surface,
                      const PointCloud& cloud,
                      const MergedCloud& merged,
                      const PointMask& used,
                      const SurfaceFitOptions& options,
                      const std::string& shape,
                      ThreadPool& pool,
                      FitReport report,
                      const Eigen::Matrix2Xd* start = nullptr,
                      const Eigen::Matrix2Xd* near = nullptr);

}  // namespace batten::internal
