// SPDX-License-Identifier: MIT
// Options of the joint optimisation: free variables, added terms, stopping rules.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "batten/fitting/progress.h"
#include "batten/fitting/residual_term.h"
#include "batten/fitting/robust_loss.h"

namespace batten::internal {

struct JointOptions {
  bool orthogonal = true;  // every point's parameters are free; else they stay as given
  bool free_weights = false, free_knots_u = false, free_knots_v = false;
  std::vector<int> fixed_control_points;  // indices, v fastest: these stay, with their weights
  std::vector<std::uint8_t> held;  // of each point of a surface: 1 where u stays, 2 where v does
  ResidualTerms terms;             // added to the distances' squares
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
  double fairness = 1e-6;    // thin plate relative to the data, so that empty cells stay smooth
  double weight_prior = 0;   // on squared logarithms of weights, at least; the data's units squared
  Progress progress = nullptr;
};

}  // namespace batten::internal
