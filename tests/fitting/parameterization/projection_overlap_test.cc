// SPDX-License-Identifier: MIT
#include "fitting/parameterization/projection_overlap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>
#include <vector>

#include "random_splines.h"

namespace batten::internal::projection_overlap_test {

constexpr double kSpacing = 0.01;

// 100 × 100 cells of a point each on the unit square, moved within their cells.
Eigen::Matrix3Xd HeightField(RandomSplines& random,
                             const std::function<double(double, double)>& height) {
  Eigen::Matrix3Xd points(3, 10000);
  for (int k = 0; k < 10000; ++k) {
    const double x = kSpacing * (k % 100 + random.Real(0, 1)),
                 y = kSpacing * (k / 100 + random.Real(0, 1));
    points.col(k) << x, y, height(x, y);
  }
  return points;
}

double Share(const Eigen::Matrix3Xd& points, double tangent = 1) {
  return LayeredPlaces(
      points, Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity(), kSpacing, tangent);
}

TEST(LayeredPlacesTest, AreNoneOnASlopeAsSteepAsSaid) {
  RandomSplines random(1);
  for (const double tangent : {0.0, 1.0, 3.0}) {
    SCOPED_TRACE(tangent);
    const double u = random.Real(-1, 1), v = std::sqrt(1 - u * u);
    EXPECT_EQ(
        Share(HeightField(random, [&](double x, double y) { return tangent * (u * x + v * y); }),
              tangent),
        0);
  }
}

TEST(LayeredPlacesTest, AreTheShareOfThePlanThatASecondSheetCovers) {
  RandomSplines random(2);
  for (const double covered : {0.2, 0.52, 1.0}) {  // of whole places, which are 0.04 wide
    SCOPED_TRACE(covered);
    // Of every other point a second one, well above 1.5 places.
    Eigen::Matrix3Xd points = HeightField(random, [](double, double) { return 0; });
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      const auto row = k / 100, column = k % 100;
      if (points(0, k) < covered && (row + column) % 2 == 0) points(2, k) = 0.2;
    }
    EXPECT_EQ(Share(points), covered);
  }
}

TEST(LayeredPlacesTest, AreNoneOfAFewStraysBesideASheet) {
  RandomSplines random(3);
  Eigen::Matrix3Xd points = HeightField(random, [](double, double) { return 0; });
  for (Eigen::Index k = 0; k < points.cols(); k += 997) points(2, k) = 5;
  EXPECT_EQ(Share(points), 0);
}

TEST(LayeredPlacesTest, DoNotDependOnTheOrderNorOnTheRoomTheyTakeUp) {
  RandomSplines random(4);
  std::mt19937_64 engine(4);
  for (int round = 0; round < 4; ++round) {
    SCOPED_TRACE(round);
    const double edge = random.Real(0.1, 0.9);
    const Eigen::Matrix3Xd points = HeightField(
        random, [&](double x, double) { return x < edge && random.Coin() ? 0.3 : 0.0; });
    const double share = Share(points);
    EXPECT_GT(share, 0);
    std::vector<Eigen::Index> order(static_cast<size_t>(points.cols()));
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), engine);
    EXPECT_EQ(Share(points(Eigen::all, order)), share);
    // A single point does not count, but leaves no room for an array of places.
    Eigen::Matrix3Xd wide(3, points.cols() + 1);
    wide << points, Eigen::Vector3d(1e5, -1e5, 0);
    EXPECT_EQ(Share(wide), share);
  }
}

TEST(LayeredPlacesTest, AreNoneWithoutASpacing) {
  EXPECT_EQ(
      LayeredPlaces(
          Eigen::Matrix3Xd::Zero(3, 9), Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity(), 0, 1),
      0);
}

}  // namespace batten::internal::projection_overlap_test
