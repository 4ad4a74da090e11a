// SPDX-License-Identifier: MIT
// Joint optimisation of a fitting problem: control points, parameters, weights and knots.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "batten/fitting/fit_report.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/free_variables.h"
#include "batten/fitting/progress.h"
#include "batten/fitting/residual_term.h"
#include "batten/fitting/robust_loss.h"
#include "batten/geometry/thread_pool.h"

namespace batten {

struct OptimizeOptions {
  FreeVariables free{.parameters =
                         true};  // besides the control points; with free parameters distances
                                 // are orthogonal, else they are at the given parameters
  bool knots_u = true, knots_v = true;  // directions that free knots move in
  int max_iterations = 40;              // > 0, of each stage
  double noise = 0;  // ≥ 0, standard deviation of the data where it is known to be no more; the
                     // optimiser's own estimate, from residuals of neighbours, needs none
  bool stop_at_noise = true;  // do not start, or go on, when the residuals are at the noise
  double least_gain = 1e-5;   // ≥ 0; a stage ends when a step gains less than this share
  Loss loss = Loss::kNone;    // on each point's distance
  double loss_scale = 1;      // > 0, standard deviation of good points, the data's units
  double fairness = 1e-6;     // ≥ 0, thin plate relative to the data
  std::vector<int> fixed_control_points;  // indices, v fastest
  std::vector<std::uint8_t> held;  // of each point of a surface: 1 where its u stays as given, 2
                                   // where v does, 3 both, 0 neither; empty: none
  ResidualTerms terms;
  double seconds = 0;  // ≥ 0; stop after so long, 0: never. Results then depend on the machine
  std::uint64_t seed = 1;  // of random starts for knots
  Progress progress = nullptr;
};

// Throws std::invalid_argument naming the field that breaks its rule.
void Check(const OptimizeOptions& options);

struct OptimizeResult {
  FittingProblem problem;          // final bases; parameters are foot points where they were free
  Eigen::MatrixXd control_points;  // d × n, v fastest
  Eigen::VectorXd weights;         // n, positive
  int iterations = 0;              // of Ceres, all stages
  double rms_before = 0, rms_after = 0;  // of the distances that were minimised
  bool ran = false;                      // whether anything was tried
  bool cancelled = false;
  std::string note;  // why nothing was tried, or what ended it
  std::vector<RoundSummary> rounds;
};

// Minimises the robust sum of squared distances of the data from the shape over control points and
// whatever else is free, in an order of stages it chooses itself:
//  · rough parameters (points whose own parameters contradict their neighbours') are first made a
//    smooth function of place by a cascade of coarse shapes;
//  · free knots start from the best that variable projection finds at fixed parameters;
//  · control points and parameters settle before weights and knots join them;
//  · knots that have come together become one of higher multiplicity, and all is solved again.
// Never worse than the shape given: in rms or, with a loss or terms, in the sum that is minimised.
// Nothing is done where the residuals are already at the noise level. Starts from `control_points`
// (d × n; d = 3, or 2 for curves in the plane) and `weights` (empty: ones). Throws
// std::invalid_argument where sizes do not agree or an option breaks its rule. Independent of the
// number of threads to rounding.
OptimizeResult Optimize(const FittingProblem& problem,
                        const Eigen::MatrixXd& control_points,
                        const Eigen::VectorXd& weights,
                        const OptimizeOptions& options,
                        ThreadPool& pool);

}  // namespace batten
