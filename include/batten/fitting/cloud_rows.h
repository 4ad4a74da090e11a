// SPDX-License-Identifier: MIT
// Point clouds from the memory in which other programs hold points.
#pragma once

#include <Eigen/Core>
#include <span>
#include <stdexcept>
#include <utility>

#include "batten/fitting/point_cloud.h"

namespace batten {

// The cloud of points that are the rows of any Eigen expression, m × 3, or m × 2 for a plane cloud:
// a matrix, a block, an Eigen::Map with strides, of float or double, in world coordinates. Throws
// std::invalid_argument unless there are two or three columns and all is finite. O(m).
template <typename Rows>
PointCloud CloudFromRows(const Eigen::MatrixBase<Rows>& rows) {
  if (rows.cols() != 2 && rows.cols() != 3) {
    throw std::invalid_argument(
        "CloudFromRows: points have two or three coordinates, a column each");
  }
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, rows.rows());
  points.topRows(rows.cols()) = rows.template cast<double>().transpose();
  return PointCloud::FromWorld(std::move(points), static_cast<int>(rows.cols()));
}

// The cloud of points x, y, z, x, y, z … (dimension 3) or x, y, x, y … (dimension 2), in world
// coordinates. Throws std::invalid_argument unless the dimension is 2 or 3, divides the number of
// coordinates, and all are finite. O(m).
PointCloud CloudFromCoordinates(std::span<const double> coordinates, int dimension = 3);
PointCloud CloudFromCoordinates(std::span<const float> coordinates, int dimension = 3);

}  // namespace batten
