// SPDX-License-Identifier: MIT
// Regularization of a surface inside data gaps.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/solve_linear.h"

namespace batten::internal {

struct GapRegularizationOptions {
  double spacing = 0;         // of the points, in parameters; an empty disc of radius 3 is a gap
  Eigen::Index measured = 0;  // how many of the problem's data are measured points, first
  int most_control_points = 20000;  // limit for added knots; 0: none are added
  bool gives_way = true;            // data at a rim may be missed to keep the surface bounded
};

struct GapRegularizationResult {
  FittingProblem problem;          // the given data over the refined bases
  LinearSolution solution;         // over those bases
  double empty_area_fraction = 0;  // of the domain
  int gaps_held = 0;               // how many gaps had to be held back
  Eigen::Index places_held = 0;    // how much of the domain that is, in places a spacing wide
};

// Solves the problem and bounds the surface in gaps wider than a knot cell. Bounds for heights (one
// row of values): in a gap surrounded by data, the range along its rim and 8 % of that; in a gap
// that reaches the domain's border, also the extrapolation by the slope at the rim, within the
// range of all data and 3 % more or, for data that are mostly tilt, within their band about their
// plane. Bounds for points (three rows): the difference to a coarse fit may be as large as at the
// rim, a tenth more, plus its slope there times the distance (half the distance where data are all
// around); the result turns and moves with the points. The noise is added to all bounds.
//
// A surface that leaves its bounds is drawn towards the membrane (harmonic surface) over the rim,
// as far as needed; by the maximum principle the membrane never leaves the range of the rim. Only
// control points that the data determine hardly or not at all are changed: at the data the surface
// moves by less than a fifth of its error from noise (rms), by more only where it would overshoot
// otherwise. Where the cells are too wide for it to turn inside the gap, those across the gap are
// halved, three times at most and not below the spacing. A surface within its bounds is returned
// bit by bit as SolveLinear returns it.
//
// Rows of values: 1 or 3. Throws std::invalid_argument for others, curves and periodic bases.
GapRegularizationResult SolveWithGapRegularization(const FittingProblem& problem,
                                                   const GapRegularizationOptions& options,
                                                   ThreadPool& pool);

}  // namespace batten::internal
