// SPDX-License-Identifier: MIT
// Directions across a direction, for standard deviations of how it may turn.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>

namespace batten::internal {

// A unit vector across a unit vector, near to the first coordinate axis 45° or more from that. It
// stays where it is when the direction turns a little, as its error does: of one that followed the
// error (Eigen's unitOrthogonal near the z axis is at right angles to it), the two components of a
// turn would be none and all of it.
inline Eigen::Vector3d SteadyAcross(const Eigen::Vector3d& direction) {
  int first = 0;
  while (first < 2 && std::abs(direction[first]) > std::numbers::sqrt2 / 2) ++first;
  const Eigen::Vector3d axis = Eigen::Vector3d::Unit(first);
  return (axis - axis.dot(direction) * direction).normalized();
}

}  // namespace batten::internal
