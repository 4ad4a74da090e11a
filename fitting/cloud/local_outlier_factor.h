// SPDX-License-Identifier: MIT
// Points that others lie near, by the measure of those others.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/point_mask.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// Of the points under a mask, those whose sixth neighbour among them is not much farther away than
// theirs from them (two and a half times the median), or that two others of whom
// that holds count among their own six nearest. Where outliers are known to be, a point that stands
// alone, by chance on the shape's continuation beyond its edge, is one of them; no surface can
// tell, for it would follow. Density may change, and edges and corners have neighbours. [Breunig et
// al. 2000, the local outlier factor, with medians] All where they are fewer than fifty. O(m log
// m).
PointMask NonIsolatedPoints(const Eigen::Matrix3Xd& points, const PointMask& mask);
PointMask NonIsolatedPoints(const Eigen::Matrix3Xd& points,
                            const PointMask& mask,
                            ThreadPool& pool);

}  // namespace batten::internal
