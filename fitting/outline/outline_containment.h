// SPDX-License-Identifier: MIT
// Smoothed borders moved, as little as can be, to hold all points.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/thread_pool.h"
#include "fitting/outline/outline_spline.h"

namespace batten::internal {

// The splines of least ∫ |move|² that hold the points, but those farther than `farthest` outside,
// and stay in the rectangle from zero to `sides`. Fixed coordinates stay. By linear conditions of
// the nearest places, a quadratic program each round (Hildreth's method), a few rounds. [Hildreth
// 1957]
void EnforceContainment(const Eigen::Matrix2Xd& points,
                        const Eigen::Vector2d& sides,
                        double farthest,
                        std::vector<OutlineSpline>& loops,
                        ThreadPool& pool);

}  // namespace batten::internal
