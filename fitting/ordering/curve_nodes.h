// SPDX-License-Identifier: MIT
// From a cloud along curves to few places on their middle lines.
#pragma once

#include <Eigen/Core>

#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// At most so many of the points, at even steps of their order.
Eigen::Matrix3Xd EveryFew(const Eigen::Matrix3Xd& points, Eigen::Index most);

// How thick and how dense points along curves are.
struct CurveScale {
  double noise = 0;    // standard deviation across the curve; 0 below 12 points
  double spacing = 0;  // median distance to the second neighbour; of many points, what it were if
                       // all lay along the middle line
};

// The noise is what is left of the neighbours of a point after a parabola through them, at the
// first number of neighbours that makes them longer than thick; the median over some hundreds of
// points. For different points in an order that tells nothing of the curve. O(m).
CurveScale ScaleOfCurves(const Eigen::Matrix3Xd& points);

// Places no two of which are nearer than `radius`. Where the noise is thicker than the points are
// apart, each has moved to the middle of the points around it (mean shift across the direction in
// which they run); else they are points of the cloud. Places with few points around them, where
// others have many, are left out. O(m log m).
Eigen::Matrix3Xd CurveNodes(const Eigen::Matrix3Xd& points,
                            double noise,
                            double radius,
                            ThreadPool& pool);

}  // namespace batten::internal
