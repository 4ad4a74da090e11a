// SPDX-License-Identifier: MIT
// A plane that shapes are mirrored in.
#pragma once

#include <Eigen/Core>

namespace batten {

// The points x with normal · x = offset.
struct MirrorPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  // of length one
  double offset = 0;

  Eigen::Vector3d Mirrored(const Eigen::Vector3d& point) const {
    return point - 2 * (normal.dot(point) - offset) * normal;
  }

  // The plane as seen from a new origin.
  MirrorPlane From(const Eigen::Vector3d& origin) const {
    return {normal, offset - normal.dot(origin)};
  }
};

}  // namespace batten
