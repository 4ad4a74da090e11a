// SPDX-License-Identifier: MIT
// The ragged border of a cloud made ready for smoothing. Lengths in units of the cloud's spacing.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace batten::internal {

struct OutlineSample {
  Eigen::Vector2d place;     // smoothed over some spacings, moved outwards
  Eigen::Vector2d measured;  // on the ragged border, moved outwards as far
  bool corner = false;       // a corner: place is where its sides meet
  bool along_cut = false;    // the way to the next sample is a straight one along a cut
};

// Closed, what is covered on the left.
using OutlineLoop = std::vector<OutlineSample>;

// A closed polygon as samples some half a spacing apart, with its corners, moved outwards by
// `outwards`. O(length).
OutlineLoop SampledOutline(const Eigen::Matrix2Xd& polygon, double outwards);

double SignedArea(const Eigen::Matrix2Xd& polygon);   // positive: counter-clockwise
Eigen::Matrix2Xd PolygonOf(const OutlineLoop& loop);  // of the places

// The parts of a region within the half plane n·x ≥ c, n = ±e_axis, with new corners where its
// borders cross the edge. Borders that cross the edge are joined along it.
std::vector<OutlineLoop> CutOutlines(const std::vector<OutlineLoop>& loops,
                                     int axis,
                                     double sign,
                                     double at);

}  // namespace batten::internal
