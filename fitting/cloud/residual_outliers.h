// SPDX-License-Identifier: MIT
// Outliers by their residuals from a first surface, told apart from structure it has missed.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/point_mask.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// Returns the residual at which outliers begin: the least doubling of `limit` beyond which the tail
// of the distances is flat, most of the points beyond it being beyond twice as much too. Noise and
// structure missed by the surface become rarer with distance; outliers do not. Infinity if the tail
// is nowhere flat.
double OutlierThreshold(const Eigen::VectorXd& distances, double limit);

// Returns the inliers of a surface, given the points' signed distances from it and their places in
// the plane: the points within OutlierThreshold(distances, least), and points beyond it where the
// surface has missed structure. These are off to the same side as several of their 8 neighbours:
// within four spacings (or the threshold, if larger) as at least 3 whose distance is within a
// factor of two, at any distance as at least 5 whose distance is within a quarter of theirs.
PointMask ResidualInliers(const Eigen::Matrix2Xd& places,
                          const Eigen::VectorXd& distances,
                          double least,
                          double spacing,
                          ThreadPool& pool);

}  // namespace batten::internal
