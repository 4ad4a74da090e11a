// SPDX-License-Identifier: MIT
// Whether points seen from one side lie over each other.
#pragma once

#include <Eigen/Core>

namespace batten::internal {

// The share of places, 4 spacings wide, whose points (in the frame of origin and axes, the third of
// them upwards) lie in layers: a gap in height that no slope explains, with a good part of the
// points on either side. Places of fewer than four points are not counted. O(m), but O(m log m)
// where points are few for the room they take up.
double LayeredPlaces(const Eigen::Matrix3Xd& points,
                     const Eigen::Vector3d& origin,
                     const Eigen::Matrix3d& axes,
                     double spacing,
                     double steepest_tangent);

}  // namespace batten::internal
