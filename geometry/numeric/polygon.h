// SPDX-License-Identifier: MIT
// Lengths, distances and angles of straight pieces.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace batten::internal {

// The lengths of a polygon's sides; its corners are columns.
template <typename Points>
Eigen::VectorXd StepLengths(const Eigen::MatrixBase<Points>& points) {
  const Eigen::Index steps = points.cols() - 1;
  return (points.rightCols(steps) - points.leftCols(steps)).colwise().norm();
}

// The sum of these lengths.
template <typename Points>
double PolygonLength(const Eigen::MatrixBase<Points>& points) {
  const Eigen::Index steps = points.cols() - 1;
  return (points.rightCols(steps) - points.leftCols(steps)).colwise().norm().sum();
}

// Sums of steps from 0 on, brought to [0, 1].
inline Eigen::VectorXd SummedSteps(const Eigen::VectorXd& steps) {
  Eigen::VectorXd sums(steps.size() + 1);
  sums[0] = 0;
  for (Eigen::Index k = 0; k < steps.size(); ++k) sums[k + 1] = sums[k] + steps[k];
  return sums / sums[steps.size()];
}

// The distance of a point from the straight piece from a to b.
inline double DistanceFromSegment(const Eigen::Vector3d& point,
                                  const Eigen::Vector3d& a,
                                  const Eigen::Vector3d& b) {
  const Eigen::Vector3d along = b - a;
  const double squared = along.squaredNorm();
  const double share = squared > 0 ? std::clamp((point - a).dot(along) / squared, 0.0, 1.0) : 0;
  return (point - a - share * along).norm();
}

// The angle between two directions, of any lengths.
inline double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// Points in space; those of a plane at z = 0.
template <typename Points>
Eigen::Matrix3Xd PointsInSpace(const Eigen::MatrixBase<Points>& points) {
  Eigen::Matrix3Xd space = Eigen::Matrix3Xd::Zero(3, points.cols());
  space.topRows(points.rows()) = points;
  return space;
}

}  // namespace batten::internal
