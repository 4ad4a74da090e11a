// SPDX-License-Identifier: MIT
// How far a surface may go in a gap, and what it goes to instead.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/solve_linear.h"
#include "fitting/surface/gap_map.h"

namespace batten::internal {

// A ball (of heights: an interval) about a centre for every place of a gap, and a smooth surface
// inside them all.
struct GapBounds {
  Eigen::MatrixXd centre;  // d × places
  Eigen::VectorXd radius;  // places
  double slack = 0;        // by so much more they may be left before knots are added
  Eigen::MatrixXd fill;    // d × places

  // How far values leave the balls; not above zero: nowhere.
  double Excess(const Eigen::MatrixXd& values) const {
    return ((values - centre).colwise().norm().transpose() - radius).maxCoeff();
  }
};

// Values of a net of the problem's bases at the places of a gap.
Eigen::MatrixXd AtPlaces(const FittingProblem& problem,
                         const Eigen::MatrixXd& coefficients,
                         const GapMap& map,
                         const std::vector<int>& places,
                         ThreadPool& pool);

// The bounds of each gap that the free solution leaves, and nothing (no columns) for the others:
// by the number of rows of the problem's values for heights or for points in space, as
// SolveWithGapRegularization says. Gaps narrower than a knot cell, or without a rim, are let be.
std::vector<GapBounds> BoundsOfGaps(const FittingProblem& problem,
                                    const LinearSolution& free,
                                    const GapMap& map,
                                    Eigen::Index measured,
                                    ThreadPool& pool);

}  // namespace batten::internal
