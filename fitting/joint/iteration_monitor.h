// SPDX-License-Identifier: MIT
// Monitor of the joint stage's steps: noise level, cancellation and record. Used by the joint stage
// only.
#pragma once

#include "fitting/joint/eliminated_problem.h"
#include "fitting/joint/joint_options.h"
#include "fitting/joint/joint_result.h"

namespace batten::internal {

// A descent ends when more steps than this are refused one after the other.
inline constexpr int kMostRefusals = 12;

// The damping nearest to a given one within the limits of all descents.
double LimitedDamping(double damping);

class IterationMonitor {
 public:
  IterationMonitor(const EliminatedProblem& cells, const JointOptions& options, JointResult& result)
      : cells_(cells), options_(options), result_(result) {}

  // Whether the remaining distances are at the noise level.
  static bool AtNoise(const EliminatedProblem& cells, const JointOptions& options);

  // Reports progress after so many iterations; true when the user cancels.
  bool Cancelled(int iterations);

  // Records the accepted state with its cost.
  void Record(double cost, double seconds);

  // Whether the state recorded last ends the descent: at the noise level, or exact.
  bool Settled();

 private:
  const EliminatedProblem& cells_;
  const JointOptions& options_;
  JointResult& result_;
};

}  // namespace batten::internal
