// SPDX-License-Identifier: MIT
// Plane over which a sheet is a height field, and the smallest rectangle in it that holds the data.
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
  double steepness = 0;  // angle (radians) to the plane that 95 % of the sheet stay below
  double overlap = 0;    // share of places with several layers: the sheet is no height field there
  bool lattice = false;  // the points are heights over a regular lattice: a plane of their own

  // Coordinates (u, v, height) of points.
  Eigen::Matrix3Xd ToFrame(const Eigen::Matrix3Xd& points) const {
    return axes.transpose() * (points.colwise() - origin);
  }
};

// Finds the plane to which the sheet is least steep, or that of the lattice over which the points
// are heights (AxisOfLatticeHeights). Its normal is the axis of the smallest cone
// that holds (all but a few of) the sheet's normals; a coordinate axis is preferred where it serves
// nearly as well, z before y before x, so that terrain stays a height field over the plan. Where
// the sheet would fold over that plane (2 % of it or more face away from it, as behind a vertical
// wall seen obliquely), the normal is the least steep direction without a fold among the coordinate
// axes, the one closest to most normals, and the principal axes; if the sheet folds over all of
// them, the first choice is kept and `overlap` reports it. The rectangle is the minimum-area one by
// rotating calipers [Freeman & Shapira 1975], or the axis-parallel one where that is nearly as
// small, widened by `margin` on every side. Throws std::invalid_argument if the points are fewer
// than three or lie on a line. `seed` chooses the points at which normals are estimated. Bit for
// bit the same for every number of threads.
PlaneBase FindPlaneBase(const Eigen::Matrix3Xd& points,
                        const NeighbourIndex& index,
                        double spacing,
                        double margin,
                        std::uint64_t seed,
                        ThreadPool& pool);

}  // namespace batten::internal
