// SPDX-License-Identifier: MIT
// Grids of points on surfaces that are known.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <random>

#include "batten/fitting/grid_data.h"

namespace batten::internal {

// Franke's function on the unit square. [Franke 1979]
inline double Franke(double x, double y) {
  const double a = 9 * x, b = 9 * y;
  return 0.75 * std::exp(-((a - 2) * (a - 2) + (b - 2) * (b - 2)) / 4) +
         0.75 * std::exp(-(a + 1) * (a + 1) / 49 - (b + 1) / 10) +
         0.5 * std::exp(-((a - 7) * (a - 7) + (b - 3) * (b - 3)) / 4) -
         0.2 * std::exp(-(a - 4) * (a - 4) - (b - 7) * (b - 7));
}

// A point for every pair of rows × columns equal steps of [0, 1].
template <typename Surface>
PointNet GridOn(const Surface& at, int rows, int columns) {
  PointNet net{rows, columns, Eigen::Matrix3Xd(3, Eigen::Index{rows} * columns), {}};
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      net.points.col(Eigen::Index{i} * columns + j) =
          at(static_cast<double>(i) / (rows - 1), static_cast<double>(j) / (columns - 1));
    }
  }
  return net;
}

inline PointNet FrankeGrid(int rows, int columns) {
  return GridOn(
      [](double x, double y) -> Eigen::Vector3d {
        return {x, y, Franke(x, y)};
      },
      rows,
      columns);
}

// A smooth bent sheet with lines that are neither straight nor evenly spaced.
inline PointNet BentGrid(int rows, int columns) {
  return GridOn(
      [](double u, double v) -> Eigen::Vector3d {
        const double a = 2.5 * (u + 0.2 * u * u), b = 1.5 * v + 0.1 * std::sin(3 * u);
        return {std::sin(a) * (1 + 0.2 * b), b + 0.1 * a * a, std::cos(a) + 0.1 * std::sin(2 * b)};
      },
      rows,
      columns);
}

// The unit sphere: rows from pole to pole, columns all round; the last column repeats the first.
inline PointNet SphereGrid(int rows, int columns) {
  return GridOn(
      [](double u, double v) -> Eigen::Vector3d {
        const double a = std::numbers::pi * u, b = 2 * std::numbers::pi * v;
        return {std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)};
      },
      rows,
      columns);
}

// Every coordinate apart by noise in [−size, size].
inline PointNet Shaken(PointNet net, double size, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> noise(-size, size);
  for (double& x : net.points.reshaped()) x += noise(engine);
  return net;
}

}  // namespace batten::internal
