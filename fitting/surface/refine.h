// SPDX-License-Identifier: MIT
// Knot refinement of a surface to a tolerance, as far as the data support it.
#pragma once

#include <cmath>

#include <optional>
#include <vector>

#include "batten/fitting/fit_report.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/progress.h"
#include "batten/geometry/nurbs_surface.h"
#include "fitting/parameterization/plane_base.h"

namespace batten::internal {

struct RefineOptions {
  double tolerance = 0;        // orthogonal distance, the data's units
  double noise = 0;            // standard deviation; errors it explains are not refined
  double held_rms = HUGE_VAL;  // of SolveWithinBounds
  double spacing = 0;          // of the points: no cell gets narrower than two thirds of it
  int max_control_points = 20000;
};

struct RefineResult {
  NurbsSurface surface;
  Eigen::Matrix2Xd parameters;  // foot points of the data
  EndCode end;
  std::vector<RoundSummary> rounds;
};

// Repeats rounds: solve, measure orthogonal distances, insert knot lines through the spans where
// most error above half the tolerance is removed per control point added. There is at most one
// control point for every 2.1 points. When no further line can be inserted, rounds of reweighting
// trade small errors for points brought within the tolerance. Returns the surface with the fewest
// points out of tolerance; where all are within it, knot lines it does not need are removed. The
// problem's values are heights over `base`, `points` its first data in space; data behind those
// only stabilise the solution. Without a base (null) the values are the points themselves.
RefineResult RefineToTolerance(const FittingProblem& problem,
                               const PlaneBase* base,
                               const Eigen::Matrix3Xd& points,
                               const RefineOptions& options,
                               ThreadPool& pool,
                               const Progress& progress = {});

}  // namespace batten::internal
