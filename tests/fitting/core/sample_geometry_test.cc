// SPDX-License-Identifier: MIT
#include "batten/fitting/sample_geometry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "batten/fitting/distances.h"
#include "exact_shapes.h"
#include "random_splines.h"
#include "refusal.h"
#include "tolerances.h"

namespace batten::internal::sample_geometry_test {

using testing::HasSubstr;

Eigen::Matrix3Xd World(const PointCloud& cloud) {
  return cloud.points().colwise() + cloud.origin();
}

// A flat unit square that is run through at very unequal speeds: x = u², y = v³ or so.
NurbsSurface UnevenSquare() {
  const SplineBasis u = SplineBasis::Uniform(2, 3, 0, 1), v = SplineBasis::Uniform(3, 4, 0, 1);
  const Eigen::Vector3d x(0, 0, 1);
  const Eigen::Vector4d y(0, 0.05, 0.2, 1);
  Eigen::Matrix3Xd points(3, 12);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 4; ++j) points.col(4 * i + j) << x[i], y[j], 0;
  }
  return NurbsSurface(u, v, points);
}

// The segment from (0, 0) to (1, 0), run through as x = u³.
NurbsCurve<2> UnevenSegment() {
  return NurbsCurve<2>(SplineBasis::Uniform(3, 4, 0, 1),
                       Eigen::Matrix2Xd{{0, 0, 0, 1}, {0, 0, 0, 0}});
}

// Whether the counts of equally likely bins are such as chance gives in all but one of a thousand
// cases and somewhat beyond. [Wilson & Hilferty 1931]
template <size_t N>
void ExpectEven(const std::array<int, N>& counts) {
  double total = 0, squares = 0;
  for (const int count : counts) total += count;
  const double expected = total / N, k = N - 1;
  for (const int count : counts) squares += (count - expected) * (count - expected) / expected;
  constexpr double kSigmas = 3.5;
  EXPECT_LE(squares, k * std::pow(1 - 2 / (9 * k) + kSigmas * std::sqrt(2 / (9 * k)), 3));
}

std::string Refusal(const SampleOptions& options) {
  return internal::RefusalOf([&] { SampleGeometry(Sphere(1), options); });
}

TEST(SampleGeometryTest, TakesPointsOfTheSurfaceItself) {
  ThreadPool pool(1);
  for (unsigned seed = 0; seed < 5; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface surface = random.Sheet(random.Integer(1, 4), random.Integer(1, 4), 0.5);
    const PointCloud cloud = SampleGeometry(surface, {.count = 200, .seed = seed});
    ASSERT_EQ(cloud.size(), 200);
    EXPECT_EQ(cloud.dimension(), 3);
    const PointDistances found = DistancesTo(surface, World(cloud), pool);
    EXPECT_LE(found.distances.cwiseAbs().maxCoeff(), kIterated * ExtentOf(surface));
  }
}

TEST(SampleGeometryTest, TakesPointsOfTheCurveItself) {
  const PointCloud cloud = SampleGeometry(Circle(2), {.count = 1000});
  for (Eigen::Index k = 0; k < cloud.size(); ++k) EXPECT_NEAR(cloud.World(k).norm(), 2, kRounding);
  ThreadPool pool(1);
  RandomSplines random(1);
  const NurbsCurve<3> curve = random.Curve<3>(3, true);
  const PointCloud in_space = SampleGeometry(curve, {.count = 200});
  EXPECT_LE(DistancesTo(curve, World(in_space), pool).distances.maxCoeff(),
            kIterated * ExtentOf(curve));
}

TEST(SampleGeometryTest, MakesPlaneCloudsOfPlaneCurves) {
  const PointCloud plane = SampleGeometry(Circle(1), {.count = 500, .noise = 0.1, .outliers = 0.2});
  EXPECT_EQ(plane.dimension(), 2);
  EXPECT_TRUE(plane.points().row(2).isZero(0));
  RandomSplines random(2);
  EXPECT_EQ(SampleGeometry(random.Curve<3>(2, false), {}).dimension(), 3);
}

TEST(SampleGeometryTest, GivesTheSamePointsForTheSameSeedOnly) {
  const SampleOptions options{.count = 300, .noise = 0.01, .outliers = 0.1, .seed = 7};
  SampleOptions other = options;
  other.seed = 8;
  const Eigen::Matrix3Xd points = World(SampleGeometry(Sphere(1), options));
  EXPECT_EQ(World(SampleGeometry(Sphere(1), options)), points);
  EXPECT_NE(World(SampleGeometry(Sphere(1), other)), points);
}

TEST(SampleGeometryTest, SpreadsPointsEvenlyByArea) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Eigen::Matrix3Xd points =
        World(SampleGeometry(UnevenSquare(), {.count = 4000, .seed = seed}));
    std::array<int, 16> counts{};
    for (const auto& p : points.colwise()) {
      ++counts[4 * std::min(3, static_cast<int>(4 * p[0])) +
               std::min(3, static_cast<int>(4 * p[1]))];
    }
    ExpectEven(counts);
  }
}

TEST(SampleGeometryTest, SpreadsPointsEvenlyOverASphere) {
  // Archimedes: slices of equal height have equal area.
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Eigen::Matrix3Xd points = World(SampleGeometry(Sphere(1), {.count = 4000, .seed = seed}));
    std::array<int, 8> slices{}, sectors{};
    for (const auto& p : points.colwise()) {
      ++slices[std::min(7, static_cast<int>(4 * (p[2] + 1)))];
      ++sectors[std::min(
          7, static_cast<int>(8 * (std::atan2(p[1], p[0]) / (2 * std::numbers::pi) + 0.5)))];
    }
    ExpectEven(slices);
    ExpectEven(sectors);
  }
}

TEST(SampleGeometryTest, SpreadsPointsEvenlyByLength) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Eigen::Matrix3Xd points =
        World(SampleGeometry(UnevenSegment(), {.count = 4000, .seed = seed}));
    std::array<int, 8> counts{};
    for (const auto& p : points.colwise()) ++counts[std::min(7, static_cast<int>(8 * p[0]))];
    ExpectEven(counts);
  }
}

TEST(SampleGeometryTest, AddsNoiseOfTheGivenDeviationToEveryCoordinate) {
  constexpr double kSigma = 0.02;
  constexpr Eigen::Index kCount = 20000;
  const Eigen::Matrix3Xd exact = World(SampleGeometry(UnevenSquare(), {.count = kCount}));
  const Eigen::Matrix3Xd noisy =
      World(SampleGeometry(UnevenSquare(), {.count = kCount, .noise = kSigma}));
  const Eigen::Matrix3Xd off = noisy - exact;  // the same places: they are drawn first
  for (int d = 0; d < 3; ++d) {
    // A deviation of 20 000 sequence_outliers by 1/sqrt(40 000) = 0.5 %, their mean by 0.7 % of it;
    // four times that.
    EXPECT_NEAR(off.row(d).norm() / std::sqrt(kCount), kSigma, 0.02 * kSigma);
    EXPECT_NEAR(off.row(d).mean(), 0, 0.03 * kSigma);
  }
  EXPECT_NEAR(off.row(0).dot(off.row(1)) / kCount, 0, 0.03 * kSigma * kSigma);
}

TEST(SampleGeometryTest, ReplacesTheGivenFractionByPointsOfTheBox) {
  for (const double fraction : {0.0, 0.05, 0.5, 1.0}) {
    SCOPED_TRACE("fraction " + std::to_string(fraction));
    const Eigen::Matrix3Xd points =
        World(SampleGeometry(Sphere(1), {.count = 10000, .outliers = fraction, .seed = 3}));
    const double off =
        static_cast<double>(((points.colwise().norm().array() - 1).abs() > kHalfDigits).count());
    // A fraction of 10 000 sequence_outliers by half a percent at the most; four times that.
    EXPECT_NEAR(off / 10000, fraction, fraction == 0 ? 0 : 0.02);
    EXPECT_LE(points.cwiseAbs().maxCoeff(), 1 + kRounding);
  }
}

TEST(SampleGeometryTest, SplitsAnOriginOffFarShapes) {
  const NurbsSurface far = Sphere(1).Translated({5e5, 5.4e6, 300});
  const PointCloud cloud = SampleGeometry(far, {.count = 100});
  EXPECT_LE(cloud.points().cwiseAbs().maxCoeff(), 3);
  EXPECT_NEAR(cloud.origin()[1], 5.4e6, 3);
}

TEST(SampleGeometryTest, RefusesOptionsThatBreakTheirRuleAndNamesThem) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(Refusal({.count = 1}), "accepted");
  for (const Eigen::Index count : {0, -5})
    EXPECT_THAT(Refusal({.count = count}), HasSubstr("count"));
  for (const double noise : {-1.0, nan, infinity})
    EXPECT_THAT(Refusal({.noise = noise}), HasSubstr("noise"));
  for (const double outliers : {-0.1, 1.1, nan}) {
    EXPECT_THAT(Refusal({.outliers = outliers}), HasSubstr("outliers"));
  }
  EXPECT_THROW(SampleGeometry(Circle(1), {.count = 0}), std::invalid_argument);
}

// A disc of the unit square, placed so that its middle is in the middle: rings and sectors of equal
// area hold equally many points, none lies outside, and a small disc is as good.
TEST(SampleGeometryTest, OfATrimmedSurfaceIsEvenOverThePart) {
  const NurbsSurface square(SplineBasis::Uniform(1, 2, 0, 1),
                            SplineBasis::Uniform(1, 2, 0, 1),
                            Eigen::Matrix3Xd{{0, 0, 1, 1}, {0, 1, 0, 1}, {0, 0, 0, 0}});
  for (const double radius : {0.4, 1e-3}) {
    constexpr int kCorners = 720;
    Eigen::Matrix2Xd corners(2, kCorners + 1);
    for (int k = 0; k <= kCorners; ++k) {
      const double angle = 2 * std::numbers::pi * (k % kCorners) / kCorners;
      corners.col(k) << 0.5 + radius * std::cos(angle), 0.5 + radius * std::sin(angle);
    }
    const NurbsCurve<2> loop(SplineBasis::Uniform(1, kCorners + 1, 0, 1), corners);
    const Eigen::Matrix3Xd points =
        World(SampleGeometry(square.WithTrims({loop}), {.count = 20000, .seed = 3}));
    std::array<int, 10> rings{}, sectors{};
    for (const Eigen::Vector3d point : points.colwise()) {
      const double x = (point[0] - 0.5) / radius, y = (point[1] - 0.5) / radius;
      const double squared = x * x + y * y;
      ASSERT_LE(squared, 1 + kIterated);
      ++rings[std::min(9, static_cast<int>(10 * squared))];
      const double turn = std::atan2(y, x) / (2 * std::numbers::pi) + 0.5;
      ++sectors[std::min(9, static_cast<int>(10 * turn))];
    }
    ExpectEven(rings);
    ExpectEven(sectors);
  }
}

}  // namespace batten::internal::sample_geometry_test
