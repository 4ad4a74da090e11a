// SPDX-License-Identifier: MIT
#include "fitting/cloud/double_layer_test.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

namespace batten::internal::double_layer_test_test {

constexpr double kLayersAbove = 0.1;  // of this share a cloud is two sheets
constexpr Eigen::Index kCount = 6000;
constexpr double kSpacing = 0.0129;  // of so many points on the unit square

// A bent sheet, a share of its points raised by `apart`.
Eigen::Matrix3Xd Sheets(double share, double apart, double sigma, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> place;
  std::normal_distribution<double> normal;
  Eigen::Matrix3Xd points(3, kCount);
  for (auto p : points.colwise()) {
    const double x = place(engine), y = place(engine), angle = 2 * (x - 0.5);
    const double r = 0.5 + (place(engine) < share ? apart : 0) + sigma * normal(engine);
    p << r * std::sin(angle), y, r * std::cos(angle);
  }
  return points;
}

double Share(const Eigen::Matrix3Xd& points, int threads = 1) {
  ThreadPool pool(threads);
  return DoubleLayerFraction(points, NeighbourIndex(points), 1, pool);
}

TEST(DoubleLayerFractionTest, IsLargeForTwoSheetsAFewSpacingsApart) {
  for (const double share : {0.5, 0.3}) {
    for (const double apart : {1.0, 2.0, 3.0}) {
      for (const double sigma : {0.0, 0.1}) {
        SCOPED_TRACE("share " + std::to_string(share) + ", apart " + std::to_string(apart) +
                     ", sigma " + std::to_string(sigma));
        const Eigen::Matrix3Xd points = Sheets(share, apart * kSpacing, sigma * kSpacing, 1);
        for (const double unit : {1e-6, 1.0, 1e6}) {
          EXPECT_GT(Share(unit * points), 5 * kLayersAbove) << "unit " << unit;
        }
      }
    }
  }
}

TEST(DoubleLayerFractionTest, IsNearlyZeroForOneSheet) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    for (const double sigma : {0.0, 1e-7, 0.1, 1.0, 3.0}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", sigma " + std::to_string(sigma));
      EXPECT_LT(Share(Sheets(0, 0, sigma * kSpacing, seed)), kLayersAbove / 2);
    }
  }
}

TEST(DoubleLayerFractionTest, IsNearlyZeroWhereShapeIsWhatAQuadricMisses) {
  // Waves of a few spacings, whose offsets keep to two heights too; lattices; a crease; a step.
  for (const double period : {8.0, 15.0, 40.0}) {
    Eigen::Matrix3Xd wave(3, 6400), scattered = Sheets(0, 0, 0, 1);
    for (int k = 0; k < 6400; ++k) {
      const double x = k / 80, y = k % 80;
      wave.col(k) << x, y, 2 * std::sin(2 * 3.14159265 * x / period);
    }
    EXPECT_LT(Share(wave), kLayersAbove) << "period " << period;
    for (auto p : scattered.colwise()) {
      p[2] += 2 * kSpacing * std::sin(2 * 3.14159265 * p[1] / (period * kSpacing));
    }
    EXPECT_LT(Share(scattered), kLayersAbove / 2) << "period " << period << ", scattered";
  }
  Eigen::Matrix3Xd crease = Sheets(0, 0, 0, 2), step = crease;
  crease.row(2) = crease.row(0).cwiseAbs();
  step.row(2) = (step.row(0).array() > 0.05).cast<double>() * 2 * kSpacing;
  EXPECT_LT(Share(crease), kLayersAbove / 2);
  EXPECT_LT(Share(step), kLayersAbove);  // beside the step there are two heights indeed
}

TEST(DoubleLayerFractionTest, IsNearlyZeroForRoundedCoordinates) {
  for (const double quantum : {1e-6, 0.01, 0.1, 0.3}) {
    Eigen::Matrix3Xd points = Sheets(0, 0, 0.05 * kSpacing, 3);
    const double q = quantum * kSpacing;
    points = (points / q).array().round().matrix() * q;
    EXPECT_LT(Share(points), kLayersAbove / 2) << "quantum " << quantum;
  }
}

TEST(DoubleLayerFractionTest, OfFewPointsIsZeroAndThreadsDoNotMatter) {
  EXPECT_EQ(Share(Sheets(0.5, 2 * kSpacing, 0, 1).leftCols(239)), 0);
  const Eigen::Matrix3Xd points = Sheets(0.5, 3.5 * kSpacing, 0.1 * kSpacing, 1);
  EXPECT_EQ(Share(points, 1), Share(points, 3));
}

}  // namespace batten::internal::double_layer_test_test
