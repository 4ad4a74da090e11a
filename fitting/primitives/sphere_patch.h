// SPDX-License-Identifier: MIT
// The part of a sphere that points cover, bounded by parallels and meridians. Used by the patches
// of fitted surfaces only.
#pragma once

#include <Eigen/Core>

#include "batten/geometry/frame.h"

namespace batten::internal {

struct SphereCover {
  Eigen::Vector3d axis, x;
  AngleRange longitude;
  Interval latitude;
};

// The part that unit directions (3 × m, m ≥ 1) cover. It is the whole sphere where no empty cap is
// more than 60° wide. Else the patch of least area about some tens of axes: across the middle of
// the points, through it, and through the middle of what is empty; poles lie within it only where
// the points are round about them. O(m).
SphereCover CoverOf(const Eigen::Matrix3Xd& directions);

}  // namespace batten::internal
