// SPDX-License-Identifier: MIT
// Whether left-out blocks of points ask for a coarser grid than single points do.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "batten/fitting/fit_report.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/progress.h"
#include "fitting/knots/grid_limits.h"

namespace batten::internal {

// The numbers of cells in u and v of the grid that foresees blocks of some eight spacings best,
// among `scored`, the choice of generalised cross-validation, and coarser grids; `scored` itself
// unless another is better by two standard errors with a fifth fewer control
// points. A grid is asked only with blocks no wider than 1.2 of its cells, for nothing bridges
// wider holes; and it must not leave more than four times the squares that `scored` leaves, for
// what is greater than the noise is shape; so is what makes the two differ in few blocks only.
// Where blocks do ask for a coarser grid, wider ones are tried from there on. `squares` gives the
// sum of squares that a grid leaves. Rounds are recorded as "block validation", with the mean
// squared error at left-out points for their score.
std::pair<int, int> CoarsenByBlockCv(const FittingProblem& problem,
                                     const GridLimits& limits,
                                     std::pair<int, int> scored,
                                     const std::function<double(std::pair<int, int>)>& squares,
                                     ThreadPool& pool,
                                     std::vector<RoundSummary>& rounds,
                                     const Progress& progress = {});

}  // namespace batten::internal
