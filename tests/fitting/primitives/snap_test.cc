// SPDX-License-Identifier: MIT
// Primitives in place of free forms: taken where the noise lets no one tell, and only there.
#include "fitting/primitives/snap.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "cases.h"
#include "fitting/core/distributions.h"
#include "measured_shapes.h"
#include "tolerances.h"

namespace batten::internal::snap_test {

using ::testing::HasSubstr;

FreeFormResidual Left(double squares, double unknowns) { return {squares, unknowns}; }

// What a free form of n unknowns that holds the truth leaves, by and large, of this noise.
double SquaresLeft(const MeasuredShape& truth,
                   const Eigen::Matrix3Xd& points,
                   double sigma,
                   double unknowns) {
  double squares = 0;
  for (const auto& p : points.colwise()) squares += std::pow(DistanceTo(truth.shape, p), 2);
  return squares - unknowns * sigma * sigma;
}

TEST(SnapTest, TakesTheKindThatThePointsAreOf) {
  RandomSplines random(1);
  ThreadPool pool(2);
  for (int trial = 0; trial < Cases(10); ++trial) {
    SCOPED_TRACE("seed 1, trial " + std::to_string(trial));
    const SurfaceKind kind = kSurfaceKinds[trial % 5];
    const MeasuredShape truth = RandomShape(kind, random);
    const double sigma = random.Logarithmic(1e-5, 1e-3);
    constexpr int kPoints = 3000;
    const Eigen::Matrix3Xd points =
        RandomPoints(truth, PieceOf(truth, 0.5, random), kPoints, random, sigma);
    const double squares = SquaresLeft(truth, points, sigma, 60);
    const std::optional<DescribedSurface> snapped =
        SnapToPrimitive(points, {}, Left(squares, 60), 1e-12, 1, pool);
    ASSERT_TRUE(snapped);
    EXPECT_EQ(snapped->summary.kind, Name(kind));
    EXPECT_THAT(snapped->summary.why, HasSubstr("explains the points as well (F = "));
    const std::string& why = snapped->summary.why;
    EXPECT_GT(std::stod(why.substr(why.find("p = ") + 4)), 0.01);
    EXPECT_LT(DistanceTo(truth.shape, snapped->surface.At(0.5, 0.5)), 5 * sigma);
    // A free form that leaves much less shows that the points are not quite of the shape.
    EXPECT_FALSE(SnapToPrimitive(points, {}, Left(0.8 * squares, 60), 1e-12, 1, pool));
    FreeFormResidual tight = Left(squares, 60);
    tight.tolerance = sigma;  // a third of normal noise is beyond
    EXPECT_FALSE(SnapToPrimitive(points, {}, tight, 1e-12, 1, pool));
  }
}

TEST(SnapTest, ExactPointsSnap) {
  RandomSplines random(2);
  ThreadPool pool(2);
  for (const SurfaceKind kind : kSurfaceKinds) {
    const MeasuredShape truth = RandomShape(kind, random);
    const Eigen::Matrix3Xd points = RandomPoints(truth, PieceOf(truth, 0.5, random), 1000, random);
    FreeFormResidual left;
    left.unknowns = 100;
    const std::optional<DescribedSurface> snapped =
        SnapToPrimitive(points, {}, left, 1e-12, 1, pool);
    ASSERT_TRUE(snapped);
    EXPECT_EQ(snapped->summary.kind, Name(kind));
  }
}

TEST(SnapTest, NothingWithoutFreedomsToCompare) {
  ThreadPool pool(1);
  const Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Random(3, 20);
  EXPECT_FALSE(SnapToPrimitive(points, {}, Left(1, 3), 1e-12, 1, pool));
  EXPECT_FALSE(SnapToPrimitive(points, {}, Left(1, 30), 1e-12, 1, pool));
}

// F with one freedom above is t², with two its tail is (1 + 2f/n)^(−n/2).
TEST(DistributionsTest, TailsAreThoseOfClosedForms) {
  for (const double f : {1e-3, 0.1, 1.0, 3.0, 20.0, 300.0}) {
    for (const double n : {1.0, 2.0, 7.0, 100.0, 1e5}) {
      const double two = std::exp(-n / 2 * std::log1p(2 * f / n));
      EXPECT_NEAR(FTail(f, 2, n), two, 1e-11 + 1e-8 * two);
    }
    const double cauchy = 1 - 2 / std::numbers::pi * std::atan(std::sqrt(f));
    EXPECT_NEAR(FTail(f, 1, 1), cauchy, 1e-13);
    EXPECT_NEAR(FTail(f, 1, 1e7), std::erfc(std::sqrt(f / 2)), 1e-6);
    EXPECT_NEAR(FTail(f, 30, 50) + FTail(1 / f, 50, 30), 1, 1e-12);
  }
  EXPECT_NEAR(FewFactor(1e7), 1, 1e-5);
  EXPECT_NEAR(3 * FewFactor(1), 1 / std::tan(0.00134989803163 * std::numbers::pi), 1e-5);
  EXPECT_TRUE(std::isinf(FewFactor(0)));
}

}  // namespace batten::internal::snap_test
