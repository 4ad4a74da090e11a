// SPDX-License-Identifier: MIT
// The least move of smoothed outlines that makes them contain all points.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/thread_pool.h"
#include "fitting/outline/outline_spline.h"

namespace batten::internal {

// Moves the splines by the least ∫ |move|² so that they contain the points, except those farther
// than `farthest` outside, and stay in the rectangle from zero to `sides`. Fixed coordinates stay,
// and so do all loops but those marked as `movable`.
// Each of a few rounds linearizes the conditions at the foot points and solves a quadratic program
// by Hildreth's method. [Hildreth 1957]
void EnforceContainment(const Eigen::Matrix2Xd& points,
                        const Eigen::Vector2d& sides,
                        double farthest,
                        const std::vector<char>& movable,
                        std::vector<OutlineSpline>& loops,
                        ThreadPool& pool);

}  // namespace batten::internal
