// SPDX-License-Identifier: MIT
// Axis of rotation estimated from the normals of a surface.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace batten::internal {

// A right-handed frame whose third direction is the axis.
struct AxisFrame {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();

  Eigen::Vector3d ToFrame(const Eigen::Vector3d& p) const {
    return axes.transpose() * (p - origin);
  }
  // The frame that results if the points are moved by a small turn and a shift in it.
  AxisFrame Moved(const Eigen::Vector3d& turn, const Eigen::Vector3d& shift) const;
};

// Returns a frame about the axis through a point. The direction's largest coordinate is made
// positive, and the first direction lies as near a coordinate axis as possible.
AxisFrame FrameAbout(const Eigen::Vector3d& point, const Eigen::Vector3d& direction);

// Returns frames about the lines that the normal lines may all meet (LinesMeetingNormals), the best
// first; `centre` is the mean of the places, `size` about their distance from it.
std::vector<AxisFrame> AxesOfRotation(const Eigen::Matrix3Xd& places,
                                      const Eigen::Matrix3Xd& normals,
                                      const Eigen::Vector3d& centre,
                                      double size);

// Returns the axes of inertia, the longest first.
std::vector<AxisFrame> AxesOfInertia(const Eigen::Matrix3Xd& places, const Eigen::Vector3d& centre);

}  // namespace batten::internal
