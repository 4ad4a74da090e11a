// SPDX-License-Identifier: MIT
// Knot refinement of a surface to a tolerance, as far as the data support it.
#pragma once

#include <vector>

#include "batten/fitting/fit_report.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/geometry/nurbs_surface.h"
#include "fitting/surface/fit_context.h"

namespace batten::internal {

struct RefineResult {
  NurbsSurface surface;
  Eigen::Matrix2Xd parameters;  // foot points of the data
  EndCode end;
  std::vector<RoundSummary> rounds;
};

// Repeats rounds: solve, measure orthogonal distances, insert knot lines through the spans where
// most error above half the tolerance is removed per control point added. There is at most one
// control point for every 2.1 points, no cell narrower than two thirds of the spacing, and errors
// that the noise explains are not refined. When no further line can be inserted, rounds of
// reweighting trade small errors for points brought within the tolerance. Returns the surface with
// the fewest points out of tolerance; where all are within it, knot lines it does not need are
// removed. `points` are the problem's data in space; its bases are kept where the control points
// are given.
RefineResult RefineToTolerance(const FitContext& context,
                               const Eigen::Matrix3Xd& points,
                               const FittingProblem& problem);

}  // namespace batten::internal
