// SPDX-License-Identifier: MIT
// The power of two that scales data to size one. Used by the optimisers only.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace batten::internal {

// The power of two next to the longest side of the columns' bounding box, so that division by it is
// exact; 1 where there is no size. Optimisers that work in it give the same steps in every unit.
inline double UnitOf(const Eigen::Ref<const Eigen::MatrixXd>& points) {
  constexpr int kMostBits = 450;  // the fourth power is still a number
  double size = 0;
  if (points.cols() > 0)
    size = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).maxCoeff();
  return size > 0 && std::isfinite(size)
             ? std::ldexp(1.0, std::clamp(std::ilogb(size), -kMostBits / 2, kMostBits / 2))
             : 1.0;
}

}  // namespace batten::internal
