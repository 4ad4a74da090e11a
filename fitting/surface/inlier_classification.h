// SPDX-License-Identifier: MIT
// Inliers, knot grid and weights of a surface fit, found together.
#pragma once

#include <vector>

#include "fitting/knots/knot_grid_selection.h"
#include "fitting/surface/fit_context.h"

namespace batten::internal {

struct ClassifiedPoints {
  PointMask used;                // inliers among the merged points
  PointCloud cloud;              // the points used
  FittingProblem problem;        // of those, over the bases chosen, with the weights of the loss
  bool robust = false;           // a loss bounds residuals
  bool noise_is_shared = false;  // blocks of left-out points found noise that neighbours share
  std::vector<TriedGrid> tried = {};  // by cross-validation
  std::vector<RoundSummary> rounds = {};
};

// The least distance from a surface, whose residuals have this scale, that an outlier is apart. A
// surface that misses the shape, by the noise, can identify only outliers far beyond the structure
// between points.
double LeastOutlierDistance(double scale,
                            double noise,
                            double spacing,
                            const SurfaceFitOptions& options);

// Classifies inliers by their neighbours before there is a surface, then by their distance from it,
// until the classification is stable: at most five passes. The bases are chosen anew each time, or
// taken from the options; weights are those of the loss where outliers were found or one is asked
// for. Throws std::invalid_argument where the points lie on two sheets; Cancelled when progress
// asks to stop.
ClassifiedPoints ClassifyInliers(FitContext& context);

}  // namespace batten::internal
