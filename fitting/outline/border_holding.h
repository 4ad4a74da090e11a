// SPDX-License-Identifier: MIT
// Smoothed borders moved, as little as can be, to hold all points.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "fitting/outline/border_spline.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// The splines of least ∫ |move|² that hold the points, but those farther than `farthest` outside,
// and stay in the rectangle from zero to `sides`. Fixed coordinates stay. By linear conditions of
// the nearest places, a quadratic program each round (Hildreth's method), a few rounds. [Hildreth
// 1957]
void HoldPoints(const Eigen::Matrix2Xd& points,
                const Eigen::Vector2d& sides,
                double farthest,
                std::vector<BorderSpline>& loops,
                ThreadPool& pool);

}  // namespace batten::internal
