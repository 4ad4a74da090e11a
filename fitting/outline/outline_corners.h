// SPDX-License-Identifier: MIT
// Corner detection on a ragged closed border.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace batten::internal {

// Left out on either side of a corner: rounded by the border's making.
inline constexpr double kCornerGap = 1.5;

inline constexpr double kLeastBorderNoise = 0.1;  // assumed of a border

struct OutlineLine {
  Eigen::Vector2d point, direction;  // of length one, the way the border runs
};

struct OutlineCorner {
  Eigen::Index index;  // of the border's point next to it
  OutlineLine before, after;
  double turn;            // to the left, in (−π, π]
  Eigen::Vector2d place;  // where the lines meet
};

// Finds corners, where straight windows on either side meet at more than 40°, in ascending order of
// their indices. `border`: points of a closed border (2 × m) one behind the other, `step` apart
// along it, in units of the cloud's spacing; ragged by up to about one. Windows are twenty long,
// then ten and five for what is shorter; two lines must explain the border clearly better than one
// circle. O(m).
std::vector<OutlineCorner> OutlineCorners(const Eigen::Matrix2Xd& border, double step);

}  // namespace batten::internal
