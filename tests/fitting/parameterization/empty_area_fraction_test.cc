// SPDX-License-Identifier: MIT
#include "fitting/parameterization/empty_area_fraction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

namespace batten::internal::empty_area_fraction_test {

constexpr double kLength = 4, kWidth = 1;

Eigen::Matrix2Xd Scattered(Eigen::Index count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  Eigen::Matrix2Xd places(2, count);
  for (Eigen::Index k = 0; k < count; ++k)
    places.col(k) << kLength * uniform(random), kWidth * uniform(random);
  return places;
}

PointMask All(const Eigen::Matrix2Xd& places) { return PointMask::Constant(places.cols(), true); }

double Share(const Eigen::Matrix2Xd& places) {
  return EmptyAreaFraction(places, All(places), kLength, kWidth);
}

// A tile misses all points of an even scatter with a chance of e⁻⁹.
TEST(EmptyAreaFractionTest, IsNothingOfAFullRectangle) {
  for (const Eigen::Index count : {500, 5000, 50000}) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      SCOPED_TRACE(std::to_string(count) + " points, seed " + std::to_string(seed));
      EXPECT_LE(Share(Scattered(count, seed)), 3e-3);
    }
  }
}

// To a tile and a half along each edge of what is missing.
TEST(EmptyAreaFractionTest, IsTheShareThatIsMissing) {
  for (const double missing : {0.1, 0.25, 0.5, 0.8}) {
    for (const Eigen::Index count : {2000, 20000}) {
      SCOPED_TRACE(std::to_string(missing) + " of it, " + std::to_string(count) + " points");
      Eigen::Matrix2Xd places = Scattered(count, 7);
      places.row(0) *= 1 - missing;
      const double side = std::sqrt(9 * kLength * kWidth / static_cast<double>(count));
      EXPECT_NEAR(Share(places), missing, 1.5 * side / kLength + 3e-3);
    }
  }
}

TEST(EmptyAreaFractionTest, AsksOnlyPointsUnderTheMask) {
  const Eigen::Matrix2Xd places = Scattered(9000, 3);
  const PointMask left = places.row(0).transpose().array() < kLength / 2;
  EXPECT_NEAR(EmptyAreaFraction(places, left, kLength, kWidth), 0.5, 0.03);
  EXPECT_EQ(EmptyAreaFraction(places, PointMask::Constant(9000, false), kLength, kWidth), 1);
}

TEST(EmptyAreaFractionTest, KnowsNoUnits) {
  const Eigen::Matrix2Xd places = Scattered(3000, 4).array().square();
  const double share = EmptyAreaFraction(places, All(places), 16, 1);
  EXPECT_GT(share, 0);
  for (const double unit : {std::ldexp(1, -20), std::ldexp(1, 20)}) {
    EXPECT_EQ(EmptyAreaFraction(unit * places, All(places), 16 * unit, unit), share);
  }
}

TEST(EmptyAreaFractionTest, StandsFewPointsAndThoseOnTheBorder) {
  EXPECT_EQ(Share(Scattered(1, 1)), 0);
  EXPECT_EQ(Share(Scattered(8, 1)), 0);
  Eigen::Matrix2Xd corners(2, 4000);
  for (Eigen::Index k = 0; k < 4000; ++k)
    corners.col(k) << (k % 2 == 0 ? 0 : kLength), (k / 2 % 2 == 0 ? 0 : kWidth);
  EXPECT_NEAR(Share(corners), 1, 0.02);
  EXPECT_LT(Share(corners), 1);
}

}  // namespace batten::internal::empty_area_fraction_test
