// SPDX-License-Identifier: MIT
// Tangents and corners of a curve given by noisy points.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace batten::internal {

// Corners: points at which the polygon turns by more than `angle` (radians, in ]0, π[) and by more
// than four times as much as at two neighbours on either side. An outlier turns the polygon half as
// much at its neighbours and is no corner. Neighbours are the nearest points that are at least
// `resolution` (≥ 0, data's units) away: a corner among points that lie closer is the sharpest of
// them. Ends are no corners. O(m) for points of similar steps.
template <int Dim>
std::vector<Eigen::Index> SharpTurns(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                                     bool closed,
                                     double angle,
                                     double resolution);

// The unit tangent at point `at` of the stretch first … last, whose indices wrap around the ends of
// the points: that of the parabola over as many neighbours on either side, up to 4096, as one
// parabola fits, to `tolerance` and to the scatter of the nearest five points. Exact points give
// few neighbours, noisy ones many. Neighbours must differ. O(1).
template <int Dim>
Eigen::Matrix<double, Dim, 1> SmoothDirection(
    const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
    Eigen::Index first,
    Eigen::Index last,
    Eigen::Index at,
    double tolerance);

}  // namespace batten::internal
