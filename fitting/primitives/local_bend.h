// SPDX-License-Identifier: MIT
// Principal curvatures of a surface at one of its points, from quadric fits. Used by the surface
// starts only.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace batten::internal {

// A point of a surface with its normal, principal directions and principal curvatures, positive
// where the surface bends away from the normal.
struct Bend {
  Eigen::Vector3d point, normal;
  std::array<Eigen::Vector3d, 2> directions;
  std::array<double, 2> curvatures;
};

// Curvatures of quadrics fitted over the plane of the points nearest to `middle`: all of them, a
// quarter, a sixteenth, …, at least nine.
std::vector<Bend> BendsNear(const Eigen::Vector3d& middle, const Eigen::Matrix3Xd& points);

}  // namespace batten::internal
