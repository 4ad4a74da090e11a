// SPDX-License-Identifier: MIT
// Distances so exact that units in the last place can be counted.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace batten::internal {

// The gap to the next larger double.
inline double Ulp(double value) {
  const double size = std::abs(value);
  return std::nextafter(size, HUGE_VAL) - size;
}

// The length, in extended precision.
inline long double ExtendedNorm(const Eigen::Matrix<long double, 3, 1>& v) {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

using Extended3 = Eigen::Matrix<long double, 3, 1>;

template <typename Point>
Extended3 Extended(const Point& p) {
  Extended3 result = Extended3::Zero();
  for (Eigen::Index k = 0; k < p.size(); ++k) result[k] = p[k];
  return result;
}

// What is left of a point without its part along an axis through `origin`.
inline Extended3 AcrossAxis(const Eigen::Vector3d& point,
                            const Eigen::Vector3d& origin,
                            const Eigen::Vector3d& axis) {
  Extended3 direction = Extended(axis);
  direction /= ExtendedNorm(direction);
  const Extended3 from = Extended(point) - Extended(origin);
  return from -
         (from[0] * direction[0] + from[1] * direction[1] + from[2] * direction[2]) * direction;
}

}  // namespace batten::internal
