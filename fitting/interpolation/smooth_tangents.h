// SPDX-License-Identifier: MIT
// Directions of a curve at points that carry noise, and where it turns sharply.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace batten::internal {

// Points at which the polygon turns by more than `angle` (radians, in ]0, π[) and by more than four
// times as much as at two neighbours on either side: a point off the curve turns it half as
// much at its neighbours and is none. Neighbours are the nearest points that are at least
// `resolution` (≥ 0, data's units) away: of a corner among points that lie closer, the
// sharpest point. Ends are none. O(m) for points of similar steps.
template <int Dim>
std::vector<Eigen::Index> SharpTurns(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                                     bool closed,
                                     double angle,
                                     double resolution);

// The unit vector of the curve's direction at point `at` of the stretch first … last, in which
// indices go round past the ends of the points: that of the parabola over as many neighbours on
// either side, up to 4096, as one describes, to `tolerance` and to what the nearest five points
// scatter. Of exact points these are few, of noisy ones many. Neighbours must differ. O(1).
template <int Dim>
Eigen::Matrix<double, Dim, 1> SmoothDirection(
    const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
    Eigen::Index first,
    Eigen::Index last,
    Eigen::Index at,
    double tolerance);

}  // namespace batten::internal
