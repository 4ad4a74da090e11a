// SPDX-License-Identifier: MIT
// The joint optimisation of control points, weights, knots and every point's parameters.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "batten/fitting/fit_report.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/progress.h"
#include "batten/fitting/residual_term.h"
#include "batten/fitting/robust_loss.h"
#include "batten/geometry/thread_pool.h"

namespace batten {

struct JointOptions {
  bool orthogonal = true;  // every point's parameters are free; else they stay as given
  bool free_weights = false, free_knots_u = false, free_knots_v = false;
  std::vector<int> fixed_control_points;  // indices, v fastest: these stay, with their weights
  std::vector<std::shared_ptr<const ResidualTerm>> terms;  // added to the distances' squares
  int max_iterations = 40;
  bool stop_at_noise = true;  // stop, or do not start, when Σ w d² falls to what noise explains, as
                              // residuals of neighbours tell
  double noise = 0;          // standard deviation where it is known to be no more; 0: not known
  double noise_slack = 0;    // share by which Σ w d² may be more than noise explains
  double size = 0;           // stop when the rms falls to rounding of this length; 0: never
  double least_gain = 1e-4;  // stop when a step gains less than this share of the cost
  double seconds = 0;        // stop after so long; 0: never
  Loss loss = Loss::kNone;   // on each point's distance
  double loss_scale = 1;     // standard deviation of good points, the data's units
  double fairness = 1e-6;    // thin plate relative to the data, so that empty cells stay calm
  double weight_prior = 0;   // on squared logarithms of weights, at least; the data's units squared
  Progress progress = nullptr;
};

// JointResult::note where the residuals are noise.
inline constexpr const char* kAtNoise = "the residuals are at the noise";

struct JointResult {
  FittingProblem problem;          // its bases and foot points are those that were found; the one
                                   // given where the start was kept
  Eigen::MatrixXd control_points;  // d × n, v fastest
  Eigen::VectorXd weights;         // of geometric mean 1 where they were free
  int iterations = 0;              // refused steps included
  double rms_before = 0, rms_after = 0;        // of the distances
  double misfit_before = 0, misfit_after = 0;  // Σ w 2ρ(d) and the terms' squares
  bool cancelled = false;
  std::string note = {};  // why it ended, when that is worth a word
  std::vector<RoundSummary> rounds = {};
};

// Minimises Σ w ρ(d_k), d_k the distance of datum k, over the control points and whatever else is
// free. Parameters are eliminated: at a foot point only the distance along the normal is left of a
// residual, so a point adds one row R_ij(u,v)·n (more at the domain's edges) to the block of its
// knot cell. All points are projected and sorted into cells before every evaluation, so points that
// cross knots are never extrapolated. Steps are damped by the point-distance matrix, and those that
// turn a normal over are refused. Where nothing but control points is free, steps are solved by
// block-banded factorisation; user's terms, weights and knots go to Ceres. Weights are free as
// logarithms, knots as logarithms of their gaps. The result is never worse than the start: in rms,
// or, with a loss or terms, in misfit. `problem` gives bases, data (points, d = 3, or 2 for plane
// curves), and parameters to start from, foot points if they are free; `weights` may be empty.
// Throws std::invalid_argument where sizes do not agree or an index is out of range. [Golub &
// Pereyra 2003, on variable projection; Wang, Pottmann & Liu 2006, on point and tangent distance]
JointResult OptimizeJointly(const FittingProblem& problem,
                            const Eigen::MatrixXd& control_points,
                            const Eigen::VectorXd& weights,
                            const JointOptions& options,
                            ThreadPool& pool);

}  // namespace batten
