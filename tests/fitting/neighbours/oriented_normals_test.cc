// SPDX-License-Identifier: MIT
#include "fitting/neighbours/oriented_normals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace batten::internal::oriented_normals_test {

// Two tori apart: about their holes too, where outwards is towards the middle of all.
TEST(OutwardNormalsTest, PointOutOfEveryBody) {
  constexpr int kPoints = 3000;
  Eigen::Matrix3Xd points(3, 2 * kPoints), outwards(3, 2 * kPoints);
  for (int k = 0; k < 2 * kPoints; ++k) {
    // Spread evenly. [Roberts 2018]
    const double a = 2 * std::numbers::pi * 0.7548776662466927 * k;
    const double b = 2 * std::numbers::pi * 0.5698402909980532 * k;
    const Eigen::Vector3d round(std::cos(a), std::sin(a), 0);
    outwards.col(k) = std::cos(b) * round + std::sin(b) * Eigen::Vector3d::UnitZ();
    points.col(k) = 2 * round + outwards.col(k) + Eigen::Vector3d(k < kPoints ? 0 : 20, 0, 0);
  }
  const Eigen::Matrix3Xd normals = OutwardNormals(NeighbourIndex(points), points, 12);
  for (int k = 0; k < 2 * kPoints; ++k) EXPECT_GT(normals.col(k).dot(outwards.col(k)), 0.9) << k;
}

}  // namespace batten::internal::oriented_normals_test
