// SPDX-License-Identifier: MIT
// How many knot cells the data ask for, when nobody said.
#pragma once

#include <vector>

#include "batten/fitting/fit_report.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/progress.h"
#include "fitting/knots/grid_limits.h"

namespace batten::internal {

// A control point counts as this many: plain cross-validation takes a few too many by chance.
// [Kim & Gu 2004]
inline constexpr double kFreedomFactor = 1.2;

struct GridChoice {
  int cells_u = 1, cells_v = 1;
  double score =
      0;  // generalised cross-validation: an estimate of the mean squared error at new points
  // Whether points left out in blocks are foreseen clearly better by this grid than by the finer
  // one of the least score: noise that neighbours share is then not followed. That other grid:
  bool blocks_disagree = false;
  int scored_cells_u = 1, scored_cells_v = 1;
  std::vector<RoundSummary> rounds;  // "cross-validation" and "block validation"
};

// The grid of least generalised cross-validation score N·RSS/(N − 1.2 n)². Grids of nearly square
// cells are tried from coarse to fine until the score has risen several times; then each direction
// is varied alone around the best. Weights must have the scale of counts (mean about 1). [Craven &
// Wahba 1979; the factor, of theirs from 1.2 to 1.4: Kim & Gu 2004]
//
// The score takes noise for independent from point to point; noise that neighbours share draws it
// to ever finer grids. So coarser grids are asked how well they foresee left-out blocks of some
// eight spacings. Where one does so clearly better, with control points clearly fewer and cells no
// narrower than the blocks, it is taken; blocks are then widened as long as that goes on. What
// varies within a block only, and no more than noise does, is not followed where that happens.
//
// A grid whose gain over a single cell chance alone explains is not taken either.
GridChoice ChooseGrid(const FittingProblem& problem,
                      const GridLimits& limits,
                      ThreadPool& pool,
                      const Progress& progress = {});

}  // namespace batten::internal
