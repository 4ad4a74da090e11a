// SPDX-License-Identifier: MIT
// A bent sheet laid out flat, so that a surface can be fitted over it.
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
  // 2 × m: lengths along the sheet, in [0, length_u] × [0, length_v]: the smallest rectangle around
  // the points reached, widened by the margin. A smooth function of the point.
  Eigen::Matrix2Xd parameters;
  PointMask reached;  // false where a point stands off the sheet: its parameters are a guess
  double length_u = 0, length_v = 0;
  double distortion = 0;  // relative change of lengths, root mean square
  double folded = 0;      // share of the nodes at which the sheet came to lie face down
  double overlap = 0;     // share of the nodes that came to lie on another part of the sheet
  double share = 0;       // of the nodes in the largest connected part
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

// Flattens the sheet that distinct points lie on: its outline and holes are free, turns of a roll
// may come within about three spacings of each other, lengths change as little as can be. Points
// should be rid of outliers, and two parallel sheets less than about five spacings apart be told
// from one by the caller. u runs along the longer side. `spacing` and `noise` are those of
// MeasureCloud. What is returned is the first attempt that serves, each looking closer than the one
// before, else the best with its refusal; parameters are always finite and inside. The same for
// every order of the points up to rounding, and bit for bit for every number of threads. Throws
// std::invalid_argument unless there are points and index, spacing, noise and margin fit them;
// Cancelled when progress asks to stop. O(m log m).
SheetBase FlattenSheet(const Eigen::Matrix3Xd& points,
                       const NeighbourIndex& index,
                       double spacing,
                       double noise,
                       double margin,
                       const SheetBaseOptions& options,
                       ThreadPool& pool,
                       const Progress& progress = {});

// The same in steps: laid out by its nodes, which are few, a sheet tells whether it serves before
// any point has a place. Points and index are referred to.
class SheetLayout {
 public:
  // The first attempt. Throws as FlattenSheet.
  SheetLayout(const Eigen::Matrix3Xd& points,
              const NeighbourIndex& index,
              double spacing,
              double noise,
              double margin,
              const SheetBaseOptions& options,
              ThreadPool& pool,
              const Progress& progress = {});

  // The attempts that look closer, while none serves.
  void LookCloser();

  const PoissonDiskSamples& nodes() const { return nodes_; }  // of the first attempt
  const SheetBase& found() const { return best_; }            // the best attempt: no parameters yet

  // With parameters of some of the points (3 × m), in the rectangle of those.
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
