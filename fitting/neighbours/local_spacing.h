// SPDX-License-Identifier: MIT
// Local spacing of points in the plane.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace batten::internal {

// Local spacing of points (2 × m) near a place relative to their mean spacing, from 1 (as dense as
// the mean, denser, or not clearly sparser) to 2. It is estimated from counts in cells eight mean
// spacings wide and in those around them, over the area that points occupy. O(m).
class LocalSpacing {
 public:
  explicit LocalSpacing(const Eigen::Matrix2Xd& points);

  double At(const Eigen::Vector2d& place) const;

 private:
  Eigen::Vector2d corner_;
  double side_;
  std::int64_t nu_, nv_;
  std::vector<float> spacing_;
};

}  // namespace batten::internal
