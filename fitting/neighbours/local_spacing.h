// SPDX-License-Identifier: MIT
// Where points in the plane are sparser than elsewhere.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace batten::internal {

// The spacing of points (2 × m) near a place, in a unit that is their mean spacing: one where they
// are as dense as that or denser or not clearly sparser, at most two. From counts in places eight
// units wide and those around them, over the area that points occupy. O(m).
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
