// SPDX-License-Identifier: MIT
// Map of a sheet with four corners onto a rectangle, whose coordinates are the parameters of a
// surface fit: for sheets that cannot be laid flat, as they would overlap or lengths would change.
#pragma once

#include <Eigen/Core>
#include <string>

#include "batten/fitting/neighbours.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/flattening/flattened_base.h"

namespace batten::internal {

// Triangulates the nodes of the sheet where it runs in space, finds the four corners of its border
// and maps it onto the rectangle, one to one: ramps and screw flights of any number of turns,
// ribbons, twisted blades. Turns of the sheet may come within some three node distances. Points and
// index are referred to; both are as for FlattenSheet. The same for every number of threads.
class RectangleLayout {
 public:
  // Throws Cancelled when progress asks to stop. O(m log m).
  RectangleLayout(const Eigen::Matrix3Xd& points,
                  const NeighbourIndex& index,
                  double noise,
                  double margin,
                  ThreadPool& pool);

  bool ok() const { return failure_reason_.empty(); }
  const std::string& failure_reason() const { return failure_reason_; }

  // Parameters of some points (3 × m), without measures; the layout must be ok. The rectangle ends
  // by the margin beyond the points reached.
  FlattenedBase Over(const Eigen::Matrix3Xd& some) const;

 private:
  // The nodes of one attempt, some thousands, and whether more would help.
  bool Attempt(Eigen::Index nodes);

  const Eigen::Matrix3Xd& points_;
  const NeighbourIndex& index_;
  double noise_, margin_;
  ThreadPool& pool_;
  std::string failure_reason_;
  SheetGraph graph_;
  Flattening charts_;
  double length_u_ = 0, length_v_ = 0;
};

}  // namespace batten::internal
