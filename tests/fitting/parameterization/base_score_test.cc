// SPDX-License-Identifier: MIT
#include "fitting/parameterization/base_score.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "bent_sheets.h"
#include "flat_bases.h"
#include "tolerances.h"

namespace batten::internal::base_score_test {

constexpr double kSigma = 2e-3;

BaseScore::Value ScoreOf(const Eigen::Matrix3Xd& points,
                         const Parameterization& base,
                         int threads = 2) {
  ThreadPool pool(threads);
  const PointCloud cloud(points);
  const SurfaceFitOptions options;
  return BaseScore(cloud, AllOf(points), options, pool)
      .Of(base, PointMask::Constant(cloud.size(), true));
}

TEST(BaseScoreTest, LooksAtASampleOfTheGoodPoints) {
  ThreadPool pool(1);
  const SurfaceFitOptions options;
  for (const Eigen::Index count : {10, 20000, 50000}) {
    const PointCloud cloud(Eigen::Matrix3Xd::Zero(3, 2 * count));
    std::vector<Eigen::Index> kept;
    for (Eigen::Index k = 0; k < count; ++k) kept.push_back(2 * k + 1);
    const PointMask sample = BaseScore(cloud, kept, options, pool).sample();
    ASSERT_EQ(sample.size(), 2 * count);
    EXPECT_EQ(sample.count(), std::min<Eigen::Index>(count, 30000));
    EXPECT_EQ(sample(kept).count(), sample.count());
  }
}

TEST(BaseScoreTest, IsTheVarianceOfTheNoiseOverTrueParameters) {
  for (const BentSheet& sheet : {FlatSheet(2, 1), ArcSheet(220), SBend()}) {
    for (unsigned seed = 1; seed <= 2; ++seed) {
      SCOPED_TRACE(sheet.name + ", seed " + std::to_string(seed));
      const SheetPoints cloud = PointsOn(sheet, {.count = 4000, .sigma = kSigma, .seed = seed});
      const BaseScore::Value value = ScoreOf(cloud.points, FlatBase(sheet, cloud));
      // Control points, some 16 to 150, add their share of 4000; the variance of so many is right
      // to 2.2 %.
      EXPECT_GT(value.score, 0.93 * kSigma * kSigma);
      EXPECT_LT(value.score, 1.15 * kSigma * kSigma);
      EXPECT_EQ(value.control_points, (value.cells_u + 3) * (value.cells_v + 3));
    }
  }
}

TEST(BaseScoreTest, IsNotFlatteredByControlPointsThatFollowTheNoise) {
  double sum = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const SheetPoints cloud = PointsOn(ShellSheet(), {.count = 300, .sigma = 1e-3, .seed = seed});
    Parameterization base;
    base.length_u = 3.5;
    base.length_v = 2;
    base.parameters = Eigen::Vector2d(3.5, 2).asDiagonal() * cloud.parameters;
    const BaseScore::Value value = ScoreOf(cloud.points, base);
    EXPECT_GT(value.control_points, 40);
    sum += value.score;
  }
  // Residuals alone would be a seventh too small and more; the variance of 1800 is right to 3.3 %.
  EXPECT_GT(sum / 6, 0.95 * 1e-3 * 1e-3);
}

TEST(BaseScoreTest, IsTheGreaterTheMoreParametersAreOff) {
  const BentSheet sheet = ArcSheet(220);
  const SheetPoints cloud = PointsOn(sheet, {.count = 4000, .sigma = kSigma});
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal;
  Eigen::Matrix2Xd off(2, 4000);
  for (double& x : off.reshaped()) x = normal(engine);
  double before = ScoreOf(cloud.points, FlatBase(sheet, cloud)).score;
  for (const double scatter : {0.05, 0.1, 0.2}) {
    Parameterization base = FlatBase(sheet, cloud);
    base.parameters = Inside(base, base.parameters + scatter * off);
    const double now = ScoreOf(cloud.points, base).score;
    EXPECT_GT(now, 1.1 * before) << scatter;
    before = now;
  }
}

TEST(BaseScoreTest, IsTheSameOverAPlaneAndOverItsPointsInSpace) {
  const BentSheet sheet = FlatSheet(2, 1);
  const SheetPoints cloud = PointsOn(sheet, {.count = 3000, .sigma = kSigma});
  const Parameterization space = FlatBase(sheet, cloud);
  Parameterization heights = space;
  heights.plane = PlaneBase{.length_u = 2, .length_v = 1};
  const double of_space = ScoreOf(cloud.points, space).score;
  EXPECT_NEAR(ScoreOf(cloud.points, heights).score, of_space, 0.02 * of_space);
}

TEST(BaseScoreTest, IsASquareOfALengthAndDoesNotDependOnThreads) {
  const BentSheet sheet = ArcSheet(150);
  const SheetPoints cloud = PointsOn(sheet, {.count = 3000, .sigma = kSigma});
  const Parameterization base = FlatBase(sheet, cloud);
  const BaseScore::Value value = ScoreOf(cloud.points, base);
  for (const double unit : {1e-6, 1e6}) {
    SCOPED_TRACE("unit " + std::to_string(unit));
    const BaseScore::Value scaled = ScoreOf(unit * cloud.points, InUnit(unit, base));
    EXPECT_NEAR(scaled.score / (unit * unit), value.score, kHalfDigits * value.score);
    EXPECT_EQ(scaled.cells_u, value.cells_u);
    EXPECT_EQ(scaled.cells_v, value.cells_v);
  }
  EXPECT_EQ(ScoreOf(cloud.points, base, 1).score, ScoreOf(cloud.points, base, 3).score);
}

TEST(BaseScoreTest, IsTheSameNearWhatItFound) {
  for (const BentSheet& sheet : {ArcSheet(150), ArcSheet(220), SBend()}) {
    SCOPED_TRACE(sheet.name);
    const SheetPoints cloud = PointsOn(sheet, {.count = 3000, .sigma = kSigma});
    const Parameterization base = FlatBase(sheet, cloud);
    ThreadPool pool(2);
    const PointCloud points(cloud.points);
    const SurfaceFitOptions options;
    const BaseScore score(points, AllOf(cloud.points), options, pool);
    const PointMask all = PointMask::Constant(points.size(), true);
    const BaseScore::Value value = score.Of(base, all), again = score.Near(base, all, value);
    EXPECT_EQ(again.score, value.score);
    EXPECT_EQ(again.cells_u, value.cells_u);
    EXPECT_EQ(again.cells_v, value.cells_v);
    // From a few cells off the same grid is found, or one as good.
    const BaseScore::Value off =
        score.Near(base, all, {0, value.cells_u + 2, std::max(1, value.cells_v - 1), 0});
    EXPECT_NEAR(off.score, value.score, 0.01 * value.score);
  }
}

TEST(BaseScoreTest, IsHardlyLessThanAFewGridsTell) {
  for (const BentSheet& sheet : {FlatSheet(2, 1), ArcSheet(220), SBend()}) {
    for (const int cells : {2, 8, 20}) {
      SCOPED_TRACE(sheet.name + ", " + std::to_string(cells));
      const SheetPoints cloud = PointsOn(sheet, {.count = 4000, .sigma = kSigma});
      const Parameterization base = FlatBase(sheet, cloud);
      ThreadPool pool(2);
      const PointCloud points(cloud.points);
      const SurfaceFitOptions options;
      const BaseScore score(points, AllOf(cloud.points), options, pool);
      const PointMask all = PointMask::Constant(points.size(), true);
      const BaseScore::Value value = score.Of(base, all),
                             bound = score.AtMost(base, all, {0, cells, cells, 0}, HUGE_VAL);
      EXPECT_GT(bound.score, 0.99 * value.score);
      // Few control points where no more are allowed.
      constexpr int kMost = 60;
      const BaseScore::Value few = score.AtMost(base, all, {0, 3, 3, 0}, kMost);
      EXPECT_LE(few.control_points, kMost);
      EXPECT_GT(few.score, 0.99 * value.score);
    }
  }
}

TEST(BaseScoreTest, IsNotSpoiltByAFewOutliers) {
  const BentSheet sheet = ArcSheet(150);
  SheetPoints cloud = PointsOn(sheet, {.count = 4000, .sigma = kSigma});
  const Parameterization base = FlatBase(sheet, cloud);
  const double clean = ScoreOf(cloud.points, base).score;
  for (Eigen::Index k = 0; k < 4000; k += 800) cloud.points.col(k) *= 1 + 100 * kSigma;
  // Five points of 100 sigma: 12.5 times the variance if their squares counted.
  EXPECT_LT(ScoreOf(cloud.points, base).score, 2 * clean);
}

}  // namespace batten::internal::base_score_test
