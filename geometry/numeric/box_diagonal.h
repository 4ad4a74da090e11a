// SPDX-License-Identifier: MIT
// The size of a set of points.
#pragma once

#include <Eigen/Core>

namespace batten::internal {

// The length of the diagonal of the points' box; points are columns.
template <typename Points>
double BoxDiagonal(const Eigen::MatrixBase<Points>& points) {
  return (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
}

}  // namespace batten::internal
