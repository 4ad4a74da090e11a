// SPDX-License-Identifier: MIT
// Isolated points by a local outlier factor with medians.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/point_mask.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// Share of outliers from which on some of them lie beside an edge of the shape.
inline constexpr double kManyStrays = 0.01;

// Returns the points under a mask without the isolated ones. A point is isolated if its sixth
// neighbour under the mask is more than 2.5 times as far away as the median of its neighbours'
// sixth neighbours, and fewer than two points that are not isolated by that count it among their
// own six nearest. In a cloud with outliers, an isolated point that happens to lie on the
// continuation of the shape beyond its edge is an outlier; residuals cannot show it, since a fitted
// surface would follow it. Among many strays also those are isolated whose second neighbour is more
// than 1.15 times as far as that median, all six on one side, and that none counts; and groups of
// fewer than thirty points, or a thousandth, that are connected with no others. Density may vary;
// points on edges and corners are kept. Below fifty points all are kept. [Breunig et al. 2000, the
// local outlier factor, with medians] O(m log m).
PointMask NonIsolatedPoints(const Eigen::Matrix3Xd& points,
                            const PointMask& mask,
                            ThreadPool& pool,
                            bool many_strays);

}  // namespace batten::internal
