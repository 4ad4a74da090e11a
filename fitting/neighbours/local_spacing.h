// SPDX-License-Identifier: MIT
// Local spacing of points in the plane.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

namespace batten::internal {

// A circle through three points that holds no other one.
struct EmptyCircle {
  Eigen::Vector2d place;  // the mean of the points
  double radius, area;    // of the circle, of the triangle
};

using PlaceInSpace = std::function<Eigen::Vector3d(const Eigen::Vector2d&)>;

// Local spacing of points (2 × m) near a place relative to their mean spacing, from 1 (as dense as
// the mean, denser, or not clearly sparser) to 16. It is the larger one of two:
//  · from the points nearest to some in cells eight mean spacings wide and in those around them, in
//    wider ones where these hold too few;
//  · where nearly all points are on lines, and large empty circles take more of the area than
//    points do: from the circles so narrow that several have room in a cell. Lines are told by the
//    whole cloud: gaps between bands of points look alike locally.
// O(m + number of circles).
class LocalSpacing {
 public:
  // `circles`: the large ones, those that tell of more than even chance. `place`: in space, if
  // these are parameters; spacings are then those in space.
  LocalSpacing(const Eigen::Matrix2Xd& points,
               const std::vector<EmptyCircle>& circles,
               const PlaceInSpace& place = nullptr);

  double At(const Eigen::Vector2d& place) const;

 private:
  Eigen::Vector2d corner_;
  double side_;
  std::int64_t nu_, nv_;
  std::vector<float> spacing_;
};

}  // namespace batten::internal
