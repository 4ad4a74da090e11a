// SPDX-License-Identifier: MIT
// Cones of directions, and what they and the extents of nets prove. Internal to geometry.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace batten::internal {

// The directions within `spread` radians of the unit axis; a spread of π says nothing.
struct DirectionCone {
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();
  double spread = std::numbers::pi;

  bool known() const { return spread < std::numbers::pi / 2; }
};

// The cone about the sum of the columns that holds them all, each moved by up to `slack`; columns
// of length zero do not count.
inline DirectionCone ConeOf(const Eigen::Matrix3Xd& directions, double slack) {
  DirectionCone cone;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& d : directions.colwise()) sum += d;
  const double length = sum.norm();
  if (!(length > 0)) return cone;
  cone.axis = sum / length;
  double least = 1, shortest = std::numeric_limits<double>::infinity();
  for (const auto& d : directions.colwise()) {
    const double size = d.norm();
    if (size == 0 && slack == 0) continue;
    if (size <= slack) return cone;
    least = std::min(least, cone.axis.dot(d) / size);
    shortest = std::min(shortest, size);
  }
  const double aside = slack > 0 ? std::asin(slack / shortest) : 0;
  cone.spread = std::min(std::acos(std::max(least, -1.0)) + aside, std::numbers::pi);
  return cone;
}

// The cone of the cross products of two cones' directions. [Sederberg & Meyers 1988]
inline DirectionCone CrossCone(const DirectionCone& a, const DirectionCone& b) {
  DirectionCone cone;
  if (!a.known() || !b.known()) return cone;
  const Eigen::Vector3d across = a.axis.cross(b.axis);
  const double sine = across.norm(), cosine = std::abs(a.axis.dot(b.axis));
  const double sa = std::sin(a.spread), sb = std::sin(b.spread);
  if (!(sine > 0)) return cone;
  cone.axis = across / sine;
  const double ratio = std::sqrt(sa * sa + 2 * sa * sb * cosine + sb * sb) / sine;
  // Beyond that angle the two cones share a direction.
  if (a.spread + b.spread < std::atan2(sine, cosine) && ratio < 1) cone.spread = std::asin(ratio);
  return cone;
}

// The angle between two lines, in [0, π/2].
inline double LineAngle(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), std::abs(a.dot(b)));
}

// Whether two sets of points are farther apart than `gap` along a unit axis, or their boxes are.
inline bool ApartAlong(const Eigen::Matrix3Xd& a,
                       const Eigen::Matrix3Xd& b,
                       const Eigen::Vector3d& axis,
                       double gap) {
  const auto extent = [&](const Eigen::Matrix3Xd& points) {
    double low = axis.dot(points.col(0)), high = low;
    for (Eigen::Index k = 1; k < points.cols(); ++k) {
      const double x = axis.dot(points.col(k));
      low = std::min(low, x);
      high = std::max(high, x);
    }
    return std::pair(low, high);
  };
  const auto [a_low, a_high] = extent(a);
  const auto [b_low, b_high] = extent(b);
  return a_low > b_high + gap || b_low > a_high + gap;
}

inline bool BoxesApart(const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b, double gap) {
  return (a.min() - b.max()).maxCoeff() > gap || (b.min() - a.max()).maxCoeff() > gap;
}

}  // namespace batten::internal
