// SPDX-License-Identifier: MIT
// Sides of points that noise hides.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/thread_pool.h"
#include "fitting/wings/wing_frame.h"

namespace batten::internal {

// Points laid round a section: −1 … 1 from edge to edge, and 0 … 1 from tip to tip.
struct WingCoordinates {
  Eigen::VectorXd around, share;
  double edge_from = 0, edge_to = 1;  // the tips of the edge, in the frame's v
  double beyond = 0;                  // of the share: the rectangle's margin at the tips

  double EdgeAt(double at_share) const { return edge_from + at_share * (edge_to - edge_from); }
  // Inside the rectangle.
  Eigen::Vector2d Parameters(double at_around, double at_share) const;
};

// Gives each unclear point a side, the sign of its `around`, by its probability beside a net
// through the clear points and the edge, so that the sheets are pushed neither apart nor together.
// It is drawn by the point's coordinates alone: no order of the points counts. O(m).
void DealOutSides(const Eigen::Matrix3Xd& points,
                  const std::vector<Eigen::Index>& clear,
                  const std::vector<Eigen::Index>& unclear,
                  const WingLine& edge,
                  double noise,
                  ThreadPool& pool,
                  WingCoordinates& at);

}  // namespace batten::internal
