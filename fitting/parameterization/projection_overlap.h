// SPDX-License-Identifier: MIT
// Overlap of a cloud projected onto a plane.
#pragma once

#include <Eigen/Core>

namespace batten::internal {

// Returns the share of cells, 4 spacings wide, whose points (in the frame of origin and axes, the
// third of them upwards) lie in layers: with a gap in height that no slope explains, and a good
// part of the points on either side. Cells of fewer than four points are not counted. O(m), but
// O(m log m) where points are few for the area they cover.
double LayeredPlaces(const Eigen::Matrix3Xd& points,
                     const Eigen::Vector3d& origin,
                     const Eigen::Matrix3d& axes,
                     double spacing,
                     double steepest_tangent);

}  // namespace batten::internal
