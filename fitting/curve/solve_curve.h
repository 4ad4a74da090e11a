// SPDX-License-Identifier: MIT
// From the points of a curve to its control points, before the joint stage.
#pragma once

#include <string>
#include <vector>

#include "fitting/curve/curve_task.h"

namespace batten::internal {

struct SolvedCurve {
  FittingProblem problem;          // over the basis found; parameters and weights as they became
  Eigen::MatrixXd control_points;  // relative to the middle, as the problem's values are
  Eigen::VectorXd weights = {};    // of the control points; empty: ones
  double squares = 0;              // Σ w d² of the solution
  EndCode end = EndCode::kCrossValidated;
  std::vector<RoundSummary> rounds = {};
  std::vector<std::string> warnings = {};
};

// At the given parameters, with the number of spans asked for or chosen by the data, or spans
// halved until the tolerance is kept; with a loss, also with its weights.
SolvedCurve SolveAtParameters(const CurveTask& task);

// More spans than the data need, with a fairness weight that suppresses the noise: chosen on means
// where there are many points, which keeps its meaning, and once more at the foot points.
SolvedCurve SolveSmoothly(const CurveTask& task);

// The number of control points asked for, with equal spans or spans adapted to the data.
SolvedCurve SolveWithControlPoints(const CurveTask& task);

// As many spans as the data distinguish, or as few as keep the tolerance; under Tukey's loss where
// none is asked for and many of the points (`outliers` of `points`) belong to no curve. Fills in
// the noise of the task where it is unknown, and clears its corners where a smooth curve serves.
SolvedCurve SolveAdaptively(CurveTask& task, Eigen::Index outliers, Eigen::Index points);

// Raises the fairness of a solution that overshoots between its data until it does not.
void PullIn(const CurveTask& task, SolvedCurve& solved);

}  // namespace batten::internal
