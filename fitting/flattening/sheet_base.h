// SPDX-License-Identifier: MIT
// Flattening of a bent sheet, whose plane coordinates are the parameters of a surface fit.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/progress.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/flattening/flattened_base.h"

namespace batten::internal {

// Flattens the sheet that distinct points lie on with as little change of lengths as possible; its
// outline and holes are free, and turns of a roll may come within about three spacings of each
// other. Points should be rid of outliers, and the caller should rule out two parallel sheets less
// than about five spacings apart. Parameters lie in the smallest rectangle around the points
// reached, widened by the margin; u runs along its longer side. `spacing` and `noise` are those of
// MeasureCloud. The few nodes are flattened first and show whether the sheet serves, before
// parameters of points are computed. Each attempt has a finer resolution than the one before; the
// first that serves counts, else the best with its failure reason. Parameters are always finite and
// inside. Points and index are referred to. The same for every order of the points up to rounding,
// and bit for bit for every number of threads. Throws std::invalid_argument unless there are points
// and index, spacing, noise and margin fit them; Cancelled when progress asks to stop. O(m log m).
class SheetLayout {
 public:
  // Makes the first attempt.
  SheetLayout(const Eigen::Matrix3Xd& points,
              const NeighbourIndex& index,
              double spacing,
              double noise,
              double margin,
              ThreadPool& pool,
              const Progress& progress = {});

  // Makes the further attempts, at finer resolution, until one serves.
  void LookCloser();

  const PoissonDiskSamples& nodes() const { return nodes_; }  // of the first attempt
  const FlattenedBase& found() const { return best_; }        // the best attempt: no parameters yet

  // Returns the best attempt with parameters of some of the points (3 × m), in their rectangle.
  FlattenedBase Over(const Eigen::Matrix3Xd& some) const;

 private:
  void Attempt();

  const Eigen::Matrix3Xd& points_;
  const NeighbourIndex& index_;
  double spacing_, noise_, margin_;
  ThreadPool& pool_;
  Progress progress_;
  int attempts_ = 0;  // made
  bool given_up_ = false;
  PoissonDiskSamples nodes_;
  FlattenedBase best_;
  SheetGraph graph_;  // of the best
  Flattening unfolding_;
};

}  // namespace batten::internal
