// SPDX-License-Identifier: MIT
// Robust least squares by iterative reweighting (IRLS).
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "batten/fitting/fit_report.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/progress.h"
#include "batten/fitting/robust_loss.h"
#include "batten/fitting/solve_linear.h"

namespace batten::internal {

struct ReweightingOptions {
  Loss loss = Loss::kTukey;                         // redescending: Huber's loss is used first
  std::optional<double> loss_scale = std::nullopt;  // estimated in every round when absent
  double least_scale = 0;                           // no smaller one is estimated
  Progress progress = nullptr;
};

// Computes the residual of every datum of a problem at its solution, in the data's units; signs do
// not count.
using ResidualsOf = std::function<Eigen::VectorXd(const FittingProblem&, const LinearSolution&)>;

// Solves and reweights at fixed bases until the scale is steady, 16 times at most; returns the
// problem with its weights multiplied by the loss's. One entry in `rounds` for each, its score the
// scale. [Holland & Welsch 1977]
FittingProblem Reweighted(const FittingProblem& problem,
                          const ReweightingOptions& options,
                          const ResidualsOf& residuals,
                          ThreadPool& pool,
                          std::vector<RoundSummary>& rounds);

}  // namespace batten::internal
