// SPDX-License-Identifier: MIT
#include "fitting/streaming/point_sample.h"

#include <gtest/gtest.h>

#include <random>

namespace batten::internal::point_sample_test {

Eigen::Matrix3Xd Points(Eigen::Index count, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> real;
  return Eigen::Matrix3Xd::NullaryExpr(3, count, [&] { return real(engine); });
}

TEST(PointSampleTest, DependsNeitherOnOrderNorOnPartsNorOnCopies) {
  const Eigen::Matrix3Xd points = Points(20000, 1);
  PointSample once(500, 1), parts(500, 1);
  once.Add(points);
  parts.Add(points.rowwise().reverse());
  parts.Add(points.middleCols(3000, 9000));
  EXPECT_EQ(once.Points(), parts.Points());
  PointSample left(500, 1), right(500, 1), both(500, 1);
  left.Add(points.leftCols(7000));
  right.Add(points.rightCols(13000));
  both.Add(right.Points());
  both.Add(left.Points());
  EXPECT_EQ(once.Points(), both.Points());
  EXPECT_EQ(once.Different(), both.Different());
}

TEST(PointSampleTest, IsSpreadAsThePointsAreAndTellsTheirNumber) {
  constexpr Eigen::Index kPoints = 200000, kKept = 4000;
  PointSample sample(kKept, 1);
  sample.Add(Points(kPoints, 2));
  const Eigen::Matrix3Xd kept = sample.Points();
  ASSERT_EQ(kept.cols(), kKept);
  // Five standard errors of a mean of uniform numbers, and of the estimate.
  const double error = 5 / std::sqrt(static_cast<double>(kKept));
  EXPECT_LT((kept.rowwise().mean().array() - 0.5).abs().maxCoeff(), error * 0.29);
  EXPECT_NEAR(sample.Different() / kPoints, 1, error);
}

TEST(PointSampleTest, FewPointsAreAllKept) {
  const Eigen::Matrix3Xd points = Points(30, 3);
  PointSample sample(100, 1);
  sample.Add(points);
  sample.Add(points);
  EXPECT_EQ(sample.Different(), 30);
  EXPECT_EQ(sample.Points().cols(), 30);
}

}  // namespace batten::internal::point_sample_test
