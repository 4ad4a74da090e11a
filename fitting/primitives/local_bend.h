// SPDX-License-Identifier: MIT
// How a surface bends at one of its points, by quadrics. Used by the starts of surfaces only.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace batten::internal {

// A point of a surface with its normal and principal directions and curvatures, positive where it
// bends away from the normal.
struct Bend {
  Eigen::Vector3d point, normal;
  std::array<Eigen::Vector3d, 2> directions;
  std::array<double, 2> curvatures;
};

// Of quadrics over the plane of the points nearest to `middle`: of all, a quarter, a sixteenth, …,
// at least nine.
std::vector<Bend> BendsNear(const Eigen::Vector3d& middle, const Eigen::Matrix3Xd& points);

}  // namespace batten::internal
