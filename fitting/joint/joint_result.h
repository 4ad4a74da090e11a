// SPDX-License-Identifier: MIT
// Result of the joint optimisation: the shape, its foot points, and the record of the steps.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "batten/fitting/fit_report.h"
#include "batten/fitting/fitting_problem.h"

namespace batten::internal {

struct JointResult {
  FittingProblem problem;          // its bases and foot points are those that were found; the one
                                   // given where the start was kept
  Eigen::MatrixXd control_points;  // d × n, v fastest
  Eigen::VectorXd weights;         // of geometric mean 1 where they were free
  int iterations = 0;              // refused steps included
  double rms_before = 0, rms_after = 0;  // of the distances
  double misfit_after = 0;               // Σ w 2ρ(d) and the terms' squares
  bool cancelled = false;
  bool at_noise = false;  // the residuals are, and the note says so
  std::string note = {};  // why it ended, when that is worth a word
  std::vector<RoundSummary> rounds = {};

  void SayAtNoise() {
    at_noise = true;
    note = "the residuals are at the noise";
  }
};

}  // namespace batten::internal
