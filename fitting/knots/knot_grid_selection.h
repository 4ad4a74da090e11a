// SPDX-License-Identifier: MIT
// Choice of the number of knot cells by generalised cross-validation.
#pragma once

#include <vector>

#include "batten/fitting/fit_report.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/progress.h"
#include "fitting/knots/grid_limits.h"

namespace batten::internal {

// Degrees of freedom that a control point counts as in the score: plain cross-validation takes a
// few too many by chance. [Kim & Gu 2004]
inline constexpr double kFreedomFactor = 1.2;

// Fewer points a control point, and the score has nothing to judge by.
inline constexpr double kLeastPointsPerControlPoint = 3;

// A grid that was solved over, with what it left of the points.
struct TriedGrid {
  int cells_u, cells_v;
  double rms;
};

struct GridChoice {
  int cells_u = 1, cells_v = 1;
  double score =
      0;  // generalised cross-validation: an estimate of the mean squared error at new points
  // Whether this grid predicts left-out blocks clearly better than the finer one of the least
  // score, so that correlated noise is not followed.
  bool blocks_disagree = false;
  std::vector<TriedGrid> tried;      // in the order in which they were
  std::vector<RoundSummary> rounds;  // "cross-validation" and "block validation"
};

// Chooses the grid of least generalised cross-validation score N·RSS/(N − 1.2 n)². Grids of nearly
// square cells are tried from coarse to fine until the score has risen several times; then each
// direction is varied alone around the best. Weights must have the scale of counts (mean about 1).
// [Craven & Wahba 1979; the factor, of theirs from 1.2 to 1.4: Kim & Gu 2004]
//
// The score assumes noise independent from point to point; correlated noise draws it to ever finer
// grids. Coarser grids are therefore tested by how well they predict left-out blocks of about eight
// spacings. Where one does so clearly better, with control points clearly fewer and cells no
// narrower than the blocks, it is taken; blocks are then widened as long as that goes on. Detail
// narrower than a block and no larger than the noise is not followed in that case.
//
// A grid whose gain over a single cell is explained by chance is not taken either.
GridChoice ChooseGrid(const FittingProblem& problem,
                      const GridLimits& limits,
                      ThreadPool& pool,
                      const Progress& progress = {});

}  // namespace batten::internal
