// SPDX-License-Identifier: MIT
// A right-handed frame of unit vectors, and ranges of lengths and angles.
#pragma once

#include <Eigen/Core>
#include <numbers>

namespace batten {

// Where a round shape stands: its axis through `origin`, and the direction from which angles count,
// counter-clockwise about the axis.
class Frame {
 public:
  // The world's axes.
  Frame() = default;

  // Given vectors are brought to length one; what is along a coordinate axis stays so exactly.
  // Without `x` it is the coordinate axis farthest from the axis (the first of equals), made
  // perpendicular; so is an `x` that is not. Throws std::invalid_argument unless all are finite,
  // the axis is not zero and x is not along it (to 1e-9).
  Frame(const Eigen::Vector3d& origin, const Eigen::Vector3d& axis);
  Frame(const Eigen::Vector3d& origin, const Eigen::Vector3d& axis, const Eigen::Vector3d& x);

  const Eigen::Vector3d& origin() const { return origin_; }
  const Eigen::Vector3d& x() const { return x_; }
  const Eigen::Vector3d& y() const { return y_; }  // axis × x
  const Eigen::Vector3d& axis() const { return axis_; }

  // The point of these coordinates.
  Eigen::Vector3d At(double x, double y, double z) const {
    return origin_ + (x * x_ + y * y_ + z * axis_);
  }

 private:
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d x_ = Eigen::Vector3d::UnitX(), y_ = Eigen::Vector3d::UnitY(),
                  axis_ = Eigen::Vector3d::UnitZ();
};

struct Interval {
  double lower = 0, upper = 1;
};

// Angles start … start + sweep, in radians. Sweeps in (0, 2π]; within 1e-12 of 2π is all round.
struct AngleRange {
  double start = 0, sweep = 2 * std::numbers::pi;

  bool full() const { return sweep >= 2 * std::numbers::pi - 1e-12; }
};

}  // namespace batten
