// SPDX-License-Identifier: MIT
// How many knot cells the data ask for, when nobody said.
#pragma once

#include <vector>

#include "batten/fitting/fit_report.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/progress.h"

namespace batten {

// A clamped basis of `cells` spans, equal but for the first and last, which are 1.6 times as wide
// where there are three or more: at an edge a cell has data on one side only.
SplineBasis FittingBasis(int degree, int cells, double lower, double upper);

struct GridLimits {
  int degree_u = 3, degree_v = 3;
  int max_control_points = 20000;
  // A grid chosen for nearly the same data: only its surroundings are searched. Both 0: everything.
  int near_cells_u = 0, near_cells_v = 0;
};

struct GridChoice {
  int cells_u = 1, cells_v = 1;
  double score =
      0;  // generalised cross-validation: an estimate of the mean squared error at new points
  std::vector<RoundSummary> rounds;
};

// The grid of least generalised cross-validation score N·RSS/(N − 1.4 n)². Grids of nearly square
// cells are tried from coarse to fine until the score has risen several times; then each direction
// is varied alone around the best. Weights must have the scale of counts (mean about 1). [Craven &
// Wahba 1979; the factor 1.4: Kim & Gu 2004]
GridChoice ChooseGrid(const FittingProblem& problem,
                      const GridLimits& limits,
                      ThreadPool& pool,
                      const Progress& progress = {});

}  // namespace batten
