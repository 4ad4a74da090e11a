// SPDX-License-Identifier: MIT
// Where every road to a surface ends: the joint stage where it pays, and the report of what came
// out.
#pragma once

#include <Eigen/Core>
#include <string>

#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/poles.h"
#include "batten/fitting/surface_options.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/core/stopwatch.h"

namespace batten::internal {

// What a road has found when no stage of its own is left.
struct SurfaceState {
  NurbsSurface surface;          // in the cloud's local coordinates, parameters in lengths
  PointCloud used;               // the points that count
  Eigen::Matrix2Xd parameters;   // of those, to start from
  Eigen::VectorXd weights;       // of those; empty: ones
  Poles poles;                   // of the surface
  bool robust = false;           // losses bound residuals
  bool noise_is_shared = false;  // by neighbours: residuals above the local noise mean nothing
};

// The distances of the used points' draft, and the joint stage with what is free by the options or,
// where they leave it open, where it pays: residuals above the noise, and points enough to carry
// free parameters. Fills report.optimize and seconds.
void OptimiseWhereItPays(SurfaceState& draft,
                         const SurfaceFitOptions& options,
                         ThreadPool& pool,
                         Stopwatch& watch,
                         FitReport& report);

// What was read and what its neighbours say.
InputSummary SummariseInput(const PointCloud& cloud,
                            Eigen::Index duplicates,
                            const CloudStatistics& statistics);

// The fit with everything the report says of it, measured on the surface as it is handed out,
// rounding of far coordinates included. `surface` is in the cloud's local coordinates, `merged`
// the cloud's different points, `used` those of them that count, `shape` what the data would have
// to be for a warning that they are not, as in "a smooth surface". With `start`, parameters of the
// merged points that are near their feet, the feet are the local ones reached from there: never
// nearer than the nearest. With `near`, parameters of the used points in their order, the nearest
// feet of all are looked for from there: the same, sooner.
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
