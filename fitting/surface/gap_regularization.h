// SPDX-License-Identifier: MIT
// Regularizing a surface where there are no points.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/solve_linear.h"

namespace batten::internal {

struct GapRegularizationOptions {
  double spacing = 0;  // of the points, in parameters: what is empty at three of it is a gap
  Eigen::Index measured = 0;        // how many of the problem's data are measured points, first
  int most_control_points = 20000;  // no knots are added beyond; 0: none at all
  bool gives_way = true;  // data at a rim may be missed where the surface would be wild otherwise
};

struct GapRegularizationResult {
  FittingProblem problem;   // the given data, over the given bases and the knots that were added
  LinearSolution solution;  // over those bases
  double empty_area_fraction = 0;  // of the domain
  int gaps_held = 0;               // how many gaps had to be held back
  Eigen::Index places_held = 0;    // how much of the domain that is, in places a spacing wide
};

// Solves, and holds the surface back in gaps wider than a knot cell where it leaves what
// surrounds them. Of heights (one row of values): inside a gap surrounded by data, the range
// along its rim and 8 % of that; where the gap reaches the domain's border, what the slope at
// the rim makes of the way besides, within the range of all data and 3 % more, or, of data that
// are mostly tilt, their band about their plane. Of points (three rows): the difference to a
// coarse fit may be what it is at the rim, a tenth more, and what its slope there makes of the
// way (of half of it where data are all around); turning and moving the points turns and moves
// the result. The noise is granted besides.
//
// Held is drawn towards the membrane stretched over the rim, as far as needed; by the maximum
// principle it never leaves the range of the rim. Only control points that data do not see, or
// hardly, are changed: where there are data the surface moves by less than a fifth of what noise
// makes of it (rms); by more only where it would shoot out otherwise. Where the cells are too
// wide for it to turn inside the gap, those across the gap are halved, three times at most and
// not below the spacing. What stays within bounds by itself is returned bit by bit as SolveLinear returns
// it.
//
// Rows of values: 1 or 3. Throws std::invalid_argument for others, curves and periodic bases.
GapRegularizationResult SolveWithGapRegularization(const FittingProblem& problem,
                                                   const GapRegularizationOptions& options,
                                                   ThreadPool& pool);

}  // namespace batten::internal
