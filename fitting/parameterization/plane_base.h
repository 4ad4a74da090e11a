// SPDX-License-Identifier: MIT
// The plane a sheet is a height field over, and the smallest rectangle in it that holds the data.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "batten/fitting/neighbours.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// A right-handed frame with a rectangle [0, length_u] × [0, length_v] in its first two axes:
// parameters are lengths in the plane, in the data's units.
struct PlaneBase {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  // columns u, v, normal
  double length_u = 1, length_v = 1;
  double steepness =
      0;               // 95 % of the sheet is less inclined to the plane than this angle (radians)
  double overlap = 0;  // share of places where the sheet lies over itself: not a height field there

  // Coordinates (u, v, height) of points.
  Eigen::Matrix3Xd ToFrame(const Eigen::Matrix3Xd& points) const {
    return axes.transpose() * (points.colwise() - origin);
  }
};

struct PlaneBaseOptions {
  int samples = 4000;      // points that carry normals
  std::uint64_t seed = 1;  // chooses them
};

// The direction in which the sheet is least steep: the axis of the smallest cone that holds (all
// but a few of) its normals; a coordinate axis is preferred where it serves nearly as well, z
// before y before x, so that terrain stays a height field over the plan. Where the sheet would
// fold over that plane (2 % of it or more look away from it, as behind a vertical wall seen from
// aside), the least steep of the upright directions in which it does not: the coordinate axes, the
// one most normals keep to, the principal axes; if it folds over all of them, the first choice
// stands and `overlap` tells. The rectangle is the
// minimum-area one by rotating calipers [Freeman & Shapira 1975], or the axis-parallel one where
// that is nearly as small, widened by `margin` on every side. Throws std::invalid_argument when the
// points are fewer than three or lie on a line, saying so.
PlaneBase FindPlaneBase(const Eigen::Matrix3Xd& points,
                        const NeighbourIndex& index,
                        double spacing,
                        double margin,
                        const PlaneBaseOptions& options = {});

// The same with threads, bit for bit.
PlaneBase FindPlaneBase(const Eigen::Matrix3Xd& points,
                        const NeighbourIndex& index,
                        double spacing,
                        double margin,
                        const PlaneBaseOptions& options,
                        ThreadPool& pool);

}  // namespace batten::internal
