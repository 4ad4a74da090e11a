// SPDX-License-Identifier: MIT
// Surface coordinates of every point on a shape (two a point). Used by the patches of fitted
// surfaces only.
#pragma once

#include <Eigen/Core>

#include "batten/geometry/thread_pool.h"
#include "fitting/core/shared_constants.h"

namespace batten::internal {

template <typename Place>
Eigen::Matrix2Xd PlacesOf(const Eigen::Matrix3Xd& points, ThreadPool& pool, const Place& place) {
  Eigen::Matrix2Xd places(2, points.cols());
  pool.For(points.cols(), kPointsPerTask, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) places.col(k) = place(points.col(k));
  });
  return places;
}

}  // namespace batten::internal
