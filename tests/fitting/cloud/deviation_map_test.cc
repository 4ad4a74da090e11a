// SPDX-License-Identifier: MIT
// Deviations as a field over a surface: constants stay, stray points do not show, gaps are gaps.
#include "batten/fitting/deviation_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::deviation_map_test {

constexpr double kSpacing = 0.02;

// A square of side 1, its middle the origin, with points at random.
Eigen::Matrix3Xd Square(RandomSplines& random, Eigen::Index count) {
  Eigen::Matrix3Xd points(3, count);
  for (auto point : points.colwise()) point << random.Real(-0.5, 0.5), random.Real(-0.5, 0.5), 0;
  return points;
}

// A wave over it whose value changes by at most 6 for a unit of length.
double Wave(const Eigen::Vector3d& at) { return std::sin(6 * at[0]) + 0.2 * std::cos(3 * at[1]); }

struct DeviationMapTest : ::testing::Test {
  RandomSplines random{7};
  ThreadPool pool{2};
  const Eigen::Index count = std::lround(1 / (kSpacing * kSpacing));
  Eigen::Matrix3Xd feet = Square(random, count), places = Square(random, 300);
  Eigen::VectorXd wave =
      Eigen::VectorXd::NullaryExpr(count, [&](Eigen::Index k) { return Wave(feet.col(k)); });
};

TEST_F(DeviationMapTest, AConstantComesBackAsItIs) {
  const Eigen::VectorXd map =
      DeviationMap(places, feet, Eigen::VectorXd::Constant(count, -0.37), 5 * kSpacing, pool);
  EXPECT_EQ(map, Eigen::VectorXd::Constant(places.cols(), -0.37));
}

TEST_F(DeviationMapTest, FollowsASmoothFieldToTheSpacingOfThePoints) {
  const Eigen::VectorXd map = DeviationMap(places, feet, wave, 5 * kSpacing, pool);
  for (Eigen::Index k = 0; k < places.cols(); ++k) {
    // 16 points lie within a radius of sqrt(16 / π) ≈ 2.3 spacings inside and 3.2 at edges.
    EXPECT_NEAR(map[k], Wave(places.col(k)), 6 * 3.2 * kSpacing);
  }
  const Eigen::VectorXd off =
      map - Eigen::VectorXd::NullaryExpr(places.cols(),
                                         [&](Eigen::Index k) { return Wave(places.col(k)); });
  EXPECT_LE(std::sqrt(off.squaredNorm() / static_cast<double>(off.size())), 3 * kSpacing);
}

TEST_F(DeviationMapTest, StrayPointsDoNotShow) {
  const Eigen::VectorXd clean = DeviationMap(places, feet, wave, 5 * kSpacing, pool);
  Eigen::VectorXd spoilt = wave;
  for (Eigen::Index k = 0; k < count; k += 12) spoilt[k] = random.Coin() ? 1e6 : -1e6;
  const Eigen::VectorXd map = DeviationMap(places, feet, spoilt, 5 * kSpacing, pool);
  EXPECT_LE((map - clean).cwiseAbs().maxCoeff(), 6 * 3.2 * kSpacing);
}

TEST_F(DeviationMapTest, NoiseIsAveraged) {
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal;
  Eigen::VectorXd noisy(count);
  for (double& d : noisy) d = normal(generator);
  const Eigen::VectorXd map = DeviationMap(places, feet, noisy, 5 * kSpacing, pool);
  // A mean of 16 would have 0.25; weights that fall with the distance count as fewer points.
  EXPECT_LE(std::sqrt(map.squaredNorm() / static_cast<double>(map.size())), 0.4);
}

TEST_F(DeviationMapTest, PlacesWithoutPointsNearHaveNone) {
  const double reach = 3 * kSpacing;
  Eigen::Matrix3Xd far = places;
  for (auto place : far.colwise()) place[2] = random.Real(0, 2 * reach);
  const Eigen::VectorXd map = DeviationMap(far, feet, wave, reach, pool);
  Eigen::Index none = 0;
  for (Eigen::Index k = 0; k < far.cols(); ++k) {
    const double nearest =
        std::sqrt((feet.colwise() - far.col(k)).colwise().squaredNorm().minCoeff());
    if (std::abs(nearest - reach) < kHalfDigits * reach) continue;  // neighbours are found in float
    EXPECT_EQ(std::isnan(map[k]), nearest > reach);
    none += std::isnan(map[k]) ? 1 : 0;
  }
  EXPECT_GT(none, far.cols() / 4);
  EXPECT_LT(none, far.cols() * 3 / 4);
}

TEST_F(DeviationMapTest, SignsUnitsAndOriginsPassThrough) {
  const double reach = 4 * kSpacing;
  const Eigen::VectorXd map = DeviationMap(places, feet, wave, reach, pool);
  // Sums run in another order.
  EXPECT_LE((DeviationMap(places, feet, -wave, reach, pool) + map).cwiseAbs().maxCoeff(),
            kRounding * wave.cwiseAbs().maxCoeff());
  const double scale = 1024;  // a power of two rounds nothing
  EXPECT_EQ(DeviationMap(scale * places, scale * feet, scale * wave, scale * reach, pool),
            scale * map);
  const Eigen::Vector3d shift(5e5, -4e6, 300);
  const Eigen::VectorXd moved =
      DeviationMap(places.colwise() + shift, feet.colwise() + shift, wave, reach, pool);
  // Rounding of coordinates, 1e-9, against what the field changes by it.
  EXPECT_LE((moved - map).cwiseAbs().maxCoeff(), kHalfDigits);
}

TEST_F(DeviationMapTest, FeetThatAreNotFiniteDoNotCountAndThreadsMakeNoDifference) {
  const double reach = 4 * kSpacing;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Eigen::VectorXd map = DeviationMap(places, feet, wave, reach, pool);
  Eigen::Matrix3Xd more(3, count + 2);
  more << feet, Eigen::Vector3d(nan, 0, 0), Eigen::Vector3d::Zero();
  Eigen::VectorXd distances(count + 2);
  distances << wave, 1, nan;
  ThreadPool alone(1);
  EXPECT_EQ(DeviationMap(places, more, distances, reach, alone), map);
  const Eigen::VectorXd none =
      DeviationMap(places, Eigen::Matrix3Xd(3, 0), Eigen::VectorXd(), reach, pool);
  EXPECT_TRUE(none.array().isNaN().all());
}

TEST_F(DeviationMapTest, FewPointsAreEnough) {
  const Eigen::Matrix3Xd two{{-0.01, 0.01}, {0, 0}, {0, 0}};
  const Eigen::Matrix3Xd here = Eigen::Vector3d::Zero();
  EXPECT_NEAR(DeviationMap(here, two, Eigen::Vector2d(1, 2), 1, pool)[0], 1.5, kRounding);
  EXPECT_EQ(DeviationMap(two, two.col(0), Eigen::VectorXd::Ones(1), 1, pool),
            Eigen::Vector2d(1, 1));
}

TEST_F(DeviationMapTest, WhatCannotBeIsRefused) {
  EXPECT_THROW(DeviationMap(places, feet, Eigen::VectorXd::Ones(2), 1, pool),
               std::invalid_argument);
  EXPECT_THROW(DeviationMap(places, feet, wave, 0, pool), std::invalid_argument);
  places(0, 0) = std::numeric_limits<double>::infinity();
  EXPECT_THROW(DeviationMap(places, feet, wave, 1, pool), std::invalid_argument);
}

}  // namespace batten::internal::deviation_map_test
