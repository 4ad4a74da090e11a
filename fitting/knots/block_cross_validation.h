// SPDX-License-Identifier: MIT
// Block cross-validation of a knot grid against coarser grids.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "batten/fitting/fit_report.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/progress.h"
#include "fitting/knots/grid_limits.h"

namespace batten::internal {

// Chooses the numbers of cells in u and v of the grid that best predicts left-out blocks of about
// eight spacings, among `scored`, the choice of generalised cross-validation, and coarser grids;
// `scored` itself unless another is better by two standard errors with a fifth fewer control
// points. A grid is tested only with blocks no wider than 1.2 of its cells, for no grid bridges
// wider gaps; and it must not leave more than four times the squares that `scored` leaves:
// residuals above the noise are shape. A difference between the two in few blocks only is shape
// too. Where blocks prefer a coarser grid, wider blocks are tried from there on. `squares` gives
// the sum of squares that a grid leaves. Rounds are recorded as "block validation", with the mean
// squared error at left-out points for their score.
std::pair<int, int> CoarsenByBlockCv(const FittingProblem& problem,
                                     const GridLimits& limits,
                                     std::pair<int, int> scored,
                                     const std::function<double(std::pair<int, int>)>& squares,
                                     ThreadPool& pool,
                                     std::vector<RoundSummary>& rounds,
                                     const Progress& progress = {});

}  // namespace batten::internal
