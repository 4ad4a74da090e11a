// SPDX-License-Identifier: MIT
// Keeping a height field calm where there are no points.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/fitting_problem.h"

namespace batten {

struct CalmOptions {
  double spacing = 0;         // of the points: width of the grid that tells where there are any
  Eigen::Index measured = 0;  // how many of the problem's data are measured points, first
};

struct CalmResult {
  FittingProblem problem;  // with what had to be added
  LinearSolution solution;
  double empty_share = 0;        // of the domain, at three spacings' width
  Eigen::Index places_held = 0;  // where the surface had to be held back
};

// Solves, and holds the height field within the range of the measured heights (a fiftieth
// more; along the border of the domain also what the usual slope makes of the strip around the
// points), or within a band about the plane of the data as narrow as theirs, all over its domain:
// where it leaves it, heights of a membrane stretched between the data are added as further data,
// heavier until they hold, and the problem is solved again. By the maximum principle a membrane
// never leaves the range of what it is fixed to. Where the surface keeps the range by itself,
// nothing is added.
CalmResult SolveCalmly(const FittingProblem& problem, const CalmOptions& options, ThreadPool& pool);

}  // namespace batten
