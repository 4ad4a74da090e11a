// SPDX-License-Identifier: MIT
// Flattening of a bent sheet, whose plane coordinates are the parameters of a surface fit.
#pragma once

#include <Eigen/Core>
#include <string>

#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/neighbours.h"
#include "batten/fitting/progress.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/flattening/arap_flattening.h"
#include "fitting/flattening/sheet_graph.h"

namespace batten::internal {

struct SheetBase {
  // Parameters (2 × m) as lengths along the sheet, in [0, length_u] × [0, length_v], the smallest
  // rectangle around the points reached, widened by the margin. A smooth function of the point.
  Eigen::Matrix2Xd parameters;
  PointMask reached;  // false where a point stands off the sheet: its parameters are a guess
  double length_u = 0, length_v = 0;
  double distortion = 0;  // relative change of lengths, root mean square
  double folded = 0;      // share of the nodes at which the flattening is turned over
  double overlap = 0;     // share of the nodes that lie on another part of the flattened sheet
  double share = 0;       // share of the nodes in the largest connected component
  bool orientation_consistent = true;  // false: one-sided, as a Möbius band
  Eigen::Index nodes = 0;
  std::string failure_reason;  // empty when the flattening serves, else why not and what to do

  bool ok() const { return failure_reason.empty(); }
};

struct SheetBaseOptions {
  Eigen::Index nodes = 2000;  // about; a second attempt takes more
  double most_distortion = 0.4;
  double most_folded = 0.002;
  double most_overlap = 0.01;
  double least_share = 0.9;
};

// Flattens the sheet that distinct points lie on with as little change of lengths as possible; its
// outline and holes are free, and turns of a roll may come within about three spacings of each
// other. Points should be rid of outliers, and the caller should rule out two parallel sheets less
// than about five spacings apart. u runs along the longer side. `spacing` and `noise` are those of
// MeasureCloud. Each attempt has a finer resolution than the one before; the first that serves is
// returned, else the best with its failure reason. Parameters are always finite and inside. The
// same for every order of the points up to rounding, and bit for bit for every number of threads.
// Throws std::invalid_argument unless there are points and index, spacing, noise and margin fit
// them; Cancelled when progress asks to stop. O(m log m).
SheetBase FlattenSheet(const Eigen::Matrix3Xd& points,
                       const NeighbourIndex& index,
                       double spacing,
                       double noise,
                       double margin,
                       const SheetBaseOptions& options,
                       ThreadPool& pool,
                       const Progress& progress = {});

// FlattenSheet in steps: the few nodes are flattened first and show whether the sheet serves,
// before parameters of points are computed. Points and index are referred to.
class SheetLayout {
 public:
  // Makes the first attempt. Throws as FlattenSheet.
  SheetLayout(const Eigen::Matrix3Xd& points,
              const NeighbourIndex& index,
              double spacing,
              double noise,
              double margin,
              const SheetBaseOptions& options,
              ThreadPool& pool,
              const Progress& progress = {});

  // Makes the further attempts, at finer resolution, until one serves.
  void LookCloser();

  const PoissonDiskSamples& nodes() const { return nodes_; }  // of the first attempt
  const SheetBase& found() const { return best_; }            // the best attempt: no parameters yet

  // Returns the best attempt with parameters of some of the points (3 × m), in their rectangle.
  SheetBase Over(const Eigen::Matrix3Xd& some) const;

 private:
  void Attempt();

  const Eigen::Matrix3Xd& points_;
  const NeighbourIndex& index_;
  double spacing_, noise_, margin_;
  SheetBaseOptions options_;
  ThreadPool& pool_;
  Progress progress_;
  int attempts_ = 0;  // made
  bool given_up_ = false;
  PoissonDiskSamples nodes_;
  SheetBase best_;
  SheetGraph graph_;  // of the best
  Flattening unfolding_;
};

}  // namespace batten::internal
