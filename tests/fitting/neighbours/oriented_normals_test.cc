// SPDX-License-Identifier: MIT
#include "fitting/neighbours/oriented_normals.h"

#include <gtest/gtest.h>

#include <cmath>

namespace batten::internal::oriented_normals_test {

// Two tori apart and a lone point: inwards about their holes too, where what is farther out from
// the middle of all is no guide.
TEST(OutwardNormalsTest, PointOutOfEveryBody) {
  constexpr int kPoints = 3000;
  Eigen::Matrix3Xd points(3, 2 * kPoints + 1), outwards(3, 2 * kPoints + 1);
  for (int k = 0; k < 2 * kPoints; ++k) {
    const double a = 0.7 * k, b = 2.399963 * k;
    const Eigen::Vector3d round(std::cos(a), std::sin(a), 0);
    outwards.col(k) = std::cos(b) * round + std::sin(b) * Eigen::Vector3d::UnitZ();
    points.col(k) = 2 * round + outwards.col(k) + Eigen::Vector3d(k < kPoints ? 0 : 20, 0, 0);
  }
  points.col(2 * kPoints) << 10, 30, 0;
  const Eigen::Matrix3Xd normals = OutwardNormals(NeighbourIndex(points), points, 12);
  EXPECT_TRUE(normals.allFinite());
  for (int k = 0; k < 2 * kPoints; ++k) EXPECT_GT(normals.col(k).dot(outwards.col(k)), 0.9) << k;
}

}  // namespace batten::internal::oriented_normals_test
