// SPDX-License-Identifier: MIT
// Bounds on a surface inside data gaps, and the smooth fill it is drawn to where it leaves them.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/solve_linear.h"
#include "fitting/surface/gap_map.h"

namespace batten::internal {

// Bounds of one gap: a ball (for heights an interval) about a centre for every place, and a smooth
// surface that lies inside all of them.
struct GapBounds {
  Eigen::MatrixXd centre;  // d × places
  Eigen::VectorXd radius;  // places
  double slack = 0;        // excess tolerated before knots are added
  Eigen::MatrixXd fill;    // d × places

  // The largest distance by which values leave the balls; zero or less where all are inside.
  double Excess(const Eigen::MatrixXd& values) const {
    return ((values - centre).colwise().norm().transpose() - radius).maxCoeff();
  }
};

// Evaluates a control net over the problem's bases at the places of a gap.
Eigen::MatrixXd AtPlaces(const FittingProblem& problem,
                         const Eigen::MatrixXd& coefficients,
                         const GapMap& map,
                         const std::vector<int>& places,
                         ThreadPool& pool);

// The bounds of each gap where the unregularized solution leaves them, empty (no columns) for the
// other gaps. One row of values means heights, three mean points in space;
// SolveWithGapRegularization gives the rules for each. Gaps narrower than a knot cell, or without a
// rim, get no bounds.
std::vector<GapBounds> BoundsOfGaps(const FittingProblem& problem,
                                    const LinearSolution& free,
                                    const GapMap& map,
                                    Eigen::Index measured,
                                    ThreadPool& pool);

}  // namespace batten::internal
