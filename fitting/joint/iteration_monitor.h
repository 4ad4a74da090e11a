// SPDX-License-Identifier: MIT
// Watches the steps of the joint stage: the noise, the user, and the record. Used by the joint
// stage only.
#pragma once

#include "fitting/joint/eliminated_problem.h"
#include "fitting/joint/joint_options.h"
#include "fitting/joint/joint_result.h"

namespace batten::internal {

class IterationMonitor {
 public:
  IterationMonitor(const EliminatedProblem& cells, const JointOptions& options, JointResult& result)
      : cells_(cells), options_(options), result_(result) {}

  // Whether what is left of the distances is noise.
  static bool AtNoise(const EliminatedProblem& cells, const JointOptions& options);

  // Asks the user whether to go on after so many iterations.
  bool Cancelled(int iterations);

  // Records the accepted state, of so much cost.
  void Record(double cost, double seconds);

  // Whether the state recorded last is the end: at the noise, or exact.
  bool Settled();

 private:
  const EliminatedProblem& cells_;
  const JointOptions& options_;
  JointResult& result_;
};

}  // namespace batten::internal
