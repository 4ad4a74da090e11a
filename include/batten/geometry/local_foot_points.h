// SPDX-License-Identifier: MIT
// Local foot points of many points at once.
#pragma once

#include <Eigen/Core>

#include "batten/geometry/foot_point.h"
#include "batten/geometry/surface_evaluator.h"
#include "batten/geometry/thread_pool.h"

namespace batten {

// Where the descents ended, one column a point.
struct LocalFootPointsKernel {
  Eigen::Matrix2Xd parameters;
  // Of the points from their feet; negative on the side that the normal there points away from.
  Eigen::VectorXd distances;
};

// The foot points LocalFootPoint finds from `starts`, to rounding, some thirty times as fast:
// eight points of one cell between knots are led down together. Where a local minimum is found
// from far away, or lies on a kink, it may be another one than LocalFootPoint's, never a place
// farther than the start. Points must be finite. What is found for a point depends neither on the
// other points nor on the number of threads. Trims are not looked at.
// Throws std::invalid_argument unless there is one start a point.
LocalFootPointsKernel LocalFootPoints(const SurfaceEvaluator& surface,
                                      const Eigen::Matrix3Xd& points,
                                      const Eigen::Matrix2Xd& starts,
                                      ThreadPool& pool);

}  // namespace batten
