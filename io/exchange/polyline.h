// SPDX-License-Identifier: MIT
// Polylines that follow a map of parameters into space. Not installed.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// Increasing parameters, beginning and ending with those of `breaks`, such that the map between
// neighbours stays within the chord tolerance of the straight line, seen at three places; every
// piece between breaks has `pieces` at least, and none is halved more than twelve times.
std::vector<double> PolylineParameters(const std::function<Eigen::Vector3d(double)>& map,
                                       std::span<const double> breaks,
                                       double chord_tolerance,
                                       int pieces);

// The ends of the domain and the distinct knots between them, in increasing order.
std::vector<double> KnotBreaks(const SplineBasis& basis);

}  // namespace batten::internal
