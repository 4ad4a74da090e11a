// SPDX-License-Identifier: MIT
// Nodes on the middle lines of a cloud along curves, and its noise and spacing.
#pragma once

#include <Eigen/Core>

#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// Returns at most `most` of the points, at even steps of their order.
Eigen::Matrix3Xd EveryFew(const Eigen::Matrix3Xd& points, Eigen::Index most);

// Noise and spacing of points along curves.
struct CurveScale {
  double noise = 0;    // standard deviation across the curve; 0 below 12 points
  double spacing = 0;  // median distance to the second neighbour; of many points, what it were if
                       // all lay along the middle line
};

// Estimates noise and spacing. The noise is the residual of a parabola through the neighbours of a
// point, at the first number of neighbours that makes them longer than thick; the median over some
// hundreds of points. Points must be distinct and in an order unrelated to the curve. O(m).
CurveScale ScaleOfCurves(const Eigen::Matrix3Xd& points);

// Returns nodes no two of which are nearer than `radius`. Where the noise exceeds the spacing of
// the points, each has moved to the middle of the points around it (mean shift across the direction
// in which they run); else they are points of the cloud. Nodes with few points around them, where
// others have many, are left out. O(m log m).
Eigen::Matrix3Xd CurveNodes(const Eigen::Matrix3Xd& points,
                            double noise,
                            double radius,
                            ThreadPool& pool);

}  // namespace batten::internal
