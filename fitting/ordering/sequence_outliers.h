// SPDX-License-Identifier: MIT
// Gross outliers among points in order along a curve.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/point_mask.h"

namespace batten::internal {

// Marks the points (3 × m, in order along an open or closed curve) that lie far off the line of
// their neighbours, up to a third of all, alone or a few in a row. Points at corners, coarse points
// and noise of any width are not marked; a doubtful point is not. Fewer than 8 points are never
// marked. Outliers less than 2 or 3 steps off are mostly found where they are rare and often missed
// where they are many, however little noise there is; where noise is wider than the steps, an
// outlier must lie 8 standard deviations off, 3 next to each other 14.
//  (1) The way through the points that is shortest in units of the steps nearby, when leaving out k
//      points in a row costs a + b k: what it leaves out is far off. From a = 0, b = 1.3 where the
//      points follow each other smoothly to a = b = 4 where noise turns the way about. By dynamic
//      programming.
//  (2) Of the others, those that lie off the chords over them, off the lines of the points before
//      and of those behind, each by far more than their neighbours do.
// Both ten times at most, each without the outliers found before. O(m).
PointMask FindSequenceOutliers(const Eigen::Matrix3Xd& points, bool closed);

}  // namespace batten::internal
