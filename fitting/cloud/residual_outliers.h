// SPDX-License-Identifier: MIT
// Telling outliers from structure by the distances of points from a first surface.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/point_mask.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// Where outliers begin: the least doubling of `limit` beyond which the tail of the distances is
// flat, most of what exceeds it exceeding even twice as much. Noise and structure the surface has
// missed thin out with distance; outliers do not care. Infinity where the tail thins out all the
// way.
double OutlierThreshold(const Eigen::VectorXd& distances, double limit);

// Which points a surface speaks for, given their signed distances from it and their places in the
// plane: those this side of where outliers begin, no nearer than `least`; and beyond it, where the
// surface is what is wrong, those that several neighbours are off with, to the same side: by nearly
// as much within the reach of structure between points (several spacings), at any distance by the
// same.
PointMask ResidualInliers(const Eigen::Matrix2Xd& places,
                          const Eigen::VectorXd& distances,
                          double least,
                          double spacing,
                          ThreadPool& pool);

}  // namespace batten::internal
