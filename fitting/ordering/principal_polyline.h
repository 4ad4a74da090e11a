// SPDX-License-Identifier: MIT
// Principal polylines of points: projection onto them, and smoothing.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/thread_pool.h"

namespace batten::internal {

struct PrincipalPolyline {
  Eigen::Matrix3Xd nodes;  // in order; a closed one does not repeat the first
  bool closed = false;

  Eigen::Index links() const { return closed ? nodes.cols() : nodes.cols() - 1; }
  auto Next(Eigen::Index link) const { return nodes.col(link + 1 < nodes.cols() ? link + 1 : 0); }

  // Arc length from the first node to each, and behind them the whole length.
  Eigen::VectorXd ArcLengths() const;
};

// The foot point of a point on the nearest guide. An open guide is extended straight at both ends,
// so that parameters may lie outside [0, length].
struct PolylinePlace {
  int guide = -1;
  double parameter = 0;  // arc length
  double distance = 0;
};
std::vector<PolylinePlace> PlacesOnPolylines(const std::vector<PrincipalPolyline>& guides,
                                             const Eigen::Matrix3Xd& points,
                                             ThreadPool& pool);

// Returns the guide of local parabolas over `reach` to both sides of parameters that are
// non-decreasing along the points, a node every `step`, but no more of them than points. An open
// one begins and ends where the points do.
PrincipalPolyline Smoothed(const Eigen::Matrix3Xd& points,
                           const Eigen::VectorXd& parameters,
                           bool closed,
                           double length,
                           double reach,
                           double step);

}  // namespace batten::internal
