// SPDX-License-Identifier: MIT
#include "fitting/cloud/local_outlier_factor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace batten::internal::local_outlier_factor_test {

// Points even in the unit square, density falling tenfold from left to right where asked for.
Eigen::Matrix3Xd Square(Eigen::Index count, bool uneven, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  Eigen::Matrix3Xd points(3, count);
  for (Eigen::Index k = 0; k < count;) {
    const double x = unit(random), y = unit(random);
    if (uneven && unit(random) > std::pow(10, -x)) continue;
    points.col(k++) << x, y, 1e-3 * unit(random);
  }
  return points;
}

PointMask Kept(const Eigen::Matrix3Xd& points, const PointMask& mask, bool many_strays = false) {
  ThreadPool alone(1);
  return NonIsolatedPoints(points, mask, alone, many_strays);
}

TEST(CompanyTest, PointsOfAShapeHaveCompany) {
  for (const int seed : {1, 2, 3}) {
    for (const bool uneven : {false, true}) {
      SCOPED_TRACE(seed);
      std::mt19937_64 random(seed);
      const Eigen::Matrix3Xd points = Square(5000, uneven, random);
      const PointMask kept = Kept(points, PointMask::Constant(5000, true));
      EXPECT_GE(kept.count(), 4998);  // a corner point may stand apart by chance
    }
  }
}

// Where the density falls to a tenth at a line, those of the thin side next to it stay.
TEST(CompanyTest, AStepOfDensityIsNoReasonToStandAlone) {
  std::mt19937_64 random(5);
  Eigen::Matrix3Xd points(3, 5500);
  points << Square(5000, false, random),
      Square(500, false, random).colwise() + Eigen::Vector3d(1, 0, 0);
  EXPECT_GE(Kept(points, PointMask::Constant(5500, true)).count(), 5496);
}

TEST(CompanyTest, StraysBesideAnEdgeHaveNone) {
  std::mt19937_64 random(7);
  Eigen::Matrix3Xd points(3, 5012);
  points.leftCols(5000) = Square(5000, false, random);
  // Five to nine spacings of 1/71 beyond the edge, far from each other: sequence_outliers in a row
  // keep each other kept.
  for (int k = 0; k < 12; ++k) {
    points.col(5000 + k) << (k + 0.5) / 12, (k % 2 ? 1.07 + 0.06 * (k % 4) / 3 : -0.07), 0;
  }
  const PointMask kept = Kept(points, PointMask::Constant(5012, true));
  EXPECT_EQ(kept.tail(12).count(), 0);
  EXPECT_GE(kept.head(5000).count(), 4998);
}

// Beyond the edge by twice as far as a sixth neighbour there, and in a loose group of their own.
TEST(CompanyTest, StraysHaveNoneNearAnEdgeNorAmongThemselves) {
  std::mt19937_64 random(8);
  constexpr int kPoints = 5000, kBeside = 8, kGroup = 25;
  Eigen::Matrix3Xd points(3, kPoints + kBeside + kGroup);
  points.leftCols(kPoints) = Square(kPoints, false, random);
  const double reach = std::sqrt(2 * 6 / (std::numbers::pi * kPoints));  // six in half a disc
  for (int k = 0; k < kBeside; ++k)
    points.col(kPoints + k) << (k + 0.5) / kBeside, 1 + 2 * reach, 0;
  for (int k = 0; k < kGroup; ++k)  // a tenth of the density along each side
    points.col(kPoints + kBeside + k) << 1.3 + 0.14 * (k % 5), 0.3 + 0.14 * (k / 5), 0.02 * (k % 3);
  const PointMask kept = Kept(points, PointMask::Constant(points.cols(), true), true);
  EXPECT_EQ(kept.tail(kBeside + kGroup).count(), 0);
  EXPECT_GE(kept.head(kPoints).count(), kPoints - 4);
}

TEST(CompanyTest, OnlyPointsUnderTheMaskAreAskedAndFewAreLetBe) {
  std::mt19937_64 random(9);
  const Eigen::Matrix3Xd points = Square(60, false, random);
  PointMask mask = PointMask::Constant(60, true);
  mask.head(20).setConstant(false);
  EXPECT_TRUE((Kept(points, mask) == mask).all());
  EXPECT_TRUE((Kept(1e6 * points, PointMask::Constant(60, true)) ==
               Kept(points, PointMask::Constant(60, true)))
                  .all());
}

}  // namespace batten::internal::local_outlier_factor_test
