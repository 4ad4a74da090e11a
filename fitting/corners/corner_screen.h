// SPDX-License-Identifier: MIT
// Screening of very many points for ranges that may hold corners. Used by FindCorners only.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "fitting/corners/corner_options.h"

namespace batten::internal {

// `size` points from `begin` on; on a closed curve the first follows the last.
struct CornerRange {
  Eigen::Index begin, size;
};

// Returns ranges that hold every corner, with as much on either side as it takes to judge one; all
// in one range where that would be most of the points, or where they are few. A corner is excluded
// where blocks of points are straight but for the noise and the lines through their means turn by
// clearly less than the least angle over a few blocks. `noise` is above 0, `step` is the median
// distance of neighbours along the curve. O(m).
std::vector<CornerRange> RangesWithCorners(const Eigen::Matrix3Xd& points,
                                           double step,
                                           const CornerOptions& options);

}  // namespace batten::internal
