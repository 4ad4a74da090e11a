// SPDX-License-Identifier: MIT
#include "fitting/cloud/inlier_prescreen.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

namespace batten::internal::inlier_prescreen_test {

constexpr double kNoise = 1e-3;

// Points of a wave over the unit square with normal noise.
Eigen::Matrix3Xd Wave(Eigen::Index count, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> place;
  std::normal_distribution<double> normal(0, kNoise);
  Eigen::Matrix3Xd points(3, count);
  for (auto p : points.colwise()) {
    const double x = place(engine), y = place(engine);
    p << x, y, 0.05 * std::sin(12 * x) * std::cos(9 * y) + normal(engine);
  }
  return points;
}

double ReachOf(Eigen::Index count) { return std::sqrt(6 / (3.14 * static_cast<double>(count))); }

PointMask Screen(const Eigen::Matrix3Xd& points, double unit = 1, int threads = 2) {
  ThreadPool pool(threads);
  return PrescreenInliers(
      points, NeighbourIndex(points), unit * kNoise, unit * ReachOf(points.cols()), pool);
}

TEST(PlaceScreenTest, NearlyAllPointsOfASheetArePlainlyGood) {
  for (unsigned seed = 1; seed < 4; ++seed) EXPECT_GE(Screen(Wave(20000, seed)).count(), 18000);
}

TEST(PlaceScreenTest, PointsOffTheSheetAreNot) {
  for (const Eigen::Index off : {20, 1000, 6000}) {
    SCOPED_TRACE(off);
    Eigen::Matrix3Xd points = Wave(20000, 5);
    std::mt19937_64 engine(6);
    std::uniform_real_distribution<double> height(10 * kNoise, 0.2);
    for (Eigen::Index k = 0; k < off; ++k)
      points(2, k) += (k % 2 == 0 ? 1 : -1) * (height(engine) + 10 * kNoise);
    EXPECT_LE(Screen(points).head(off).count(), off / 1000);
  }
}

// Half a dozen deviations are no noise: such points are judged one by one.
TEST(PlaceScreenTest, PointsSixToEightDeviationsOffAreNotPlainlyGood) {
  for (const Eigen::Index off : {20, 400, 1000}) {
    SCOPED_TRACE(off);
    Eigen::Matrix3Xd points = Wave(20000, 11);
    const Eigen::Matrix3Xd clean = points;
    std::mt19937_64 engine(12);
    std::uniform_real_distribution<double> deviations(6, 8);
    for (Eigen::Index k = 0; k < off; ++k) {
      // From the wave itself, not from a point that noise has moved.
      const double x = points(0, k), y = points(1, k);
      points(2, k) = 0.05 * std::sin(12 * x) * std::cos(9 * y) +
                     (k % 2 == 0 ? 1 : -1) * deviations(engine) * kNoise;
    }
    const PointMask good = Screen(points);
    EXPECT_LE(good.head(off).count(), off / 100);
    // What stays on the wave is good as before, where it has no such point beside it.
    EXPECT_GE(good.tail(20000 - off).count(), Screen(clean).tail(20000 - off).count() * 7 / 10);
  }
}

TEST(PlaceScreenTest, ClumpsBesideTheSheetAreNot) {
  Eigen::Matrix3Xd points = Wave(20000, 7);
  std::mt19937_64 engine(8);
  std::normal_distribution<double> normal(0, 3e-3);
  for (Eigen::Index k = 0; k < 400; ++k) {
    const double clump = static_cast<double>(k / 8);
    points.col(k) << clump / 50 + normal(engine), std::fmod(clump * 0.37, 1.0) + normal(engine),
        0.15 + normal(engine);
  }
  EXPECT_EQ(Screen(points).head(400).count(), 0);
}

TEST(PlaceScreenTest, LinesClustersAndFewPointsAreLeftToOthers) {
  Eigen::Matrix3Xd line = Eigen::Matrix3Xd::Zero(3, 2000);
  for (Eigen::Index k = 0; k < 2000; ++k) line(0, k) = static_cast<double>(k);
  EXPECT_EQ(Screen(line).count(), 0);
  EXPECT_EQ(Screen(Eigen::Matrix3Xd::Zero(3, 2000)).count(), 0);
  EXPECT_EQ(Screen(Wave(63, 1)).count(), 0);
}

TEST(PlaceScreenTest, NeitherUnitNorThreadsMatter) {
  const Eigen::Matrix3Xd points = Wave(5000, 9);
  const PointMask expected = Screen(points);
  for (const double unit : {0x1p-100, 0x1p100})
    EXPECT_TRUE((Screen(unit * points, unit) == expected).all()) << unit;
  EXPECT_TRUE((Screen(points, 1, 1) == expected).all());
  EXPECT_TRUE((Screen(points, 1, 3) == expected).all());
}

}  // namespace batten::internal::inlier_prescreen_test
