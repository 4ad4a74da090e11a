// SPDX-License-Identifier: MIT
// Clouds with known truth: the shapes every table of this folder is about.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

namespace batten::internal {

// Franke's test function on the unit square. [Franke 1979]
inline double Franke(double x, double y) {
  const auto square = [](double t) { return t * t; };
  return 0.75 * std::exp(-(square(9 * x - 2) + square(9 * y - 2)) / 4) +
         0.75 * std::exp(-square(9 * x + 1) / 49 - (9 * y + 1) / 10) +
         0.5 * std::exp(-(square(9 * x - 7) + square(9 * y - 3)) / 4) -
         0.2 * std::exp(-square(9 * x - 4) - square(9 * y - 7));
}

inline double Tilted(double x, double y) { return 0.3 * x - 0.2 * y; }

// Scattered points of z(x,y) on the unit square with normal noise in z; `outliers` of them are
// lifted or sunk by up to 0.3.
template <typename Height>
Eigen::Matrix3Xd Scatter(
    Height height, Eigen::Index count, double sigma, double outliers, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  const auto uniform = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  const auto normal = [&] {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    return radius * std::cos(2 * std::numbers::pi * uniform());
  };
  Eigen::Matrix3Xd points(3, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double x = uniform(), y = uniform();
    double z = height(x, y) + sigma * normal();
    if (outliers > 0 && uniform() < outliers) z += 0.6 * (uniform() - 0.5);
    points.col(k) << x, y, z;
  }
  return points;
}

// Points of the noise-free surface on a grid of the unit square.
template <typename Height>
Eigen::Matrix3Xd TruthGrid(Height height, int side) {
  Eigen::Matrix3Xd points(3, Eigen::Index{side} * side);
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      const double x = static_cast<double>(i) / (side - 1), y = static_cast<double>(j) / (side - 1);
      points.col(Eigen::Index{i} * side + j) << x, y, height(x, y);
    }
  }
  return points;
}

}  // namespace batten::internal
