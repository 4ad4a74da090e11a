// SPDX-License-Identifier: MIT
#include "fitting/ordering/curve_closure.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>
#include <stdexcept>
#include <string>

#include "ordered_curves.h"
#include "tolerances.h"

namespace batten::internal::curve_closure_test {

Eigen::Matrix3Xd WithoutLast(const Eigen::Matrix3Xd& points) {
  return points.leftCols(points.cols() - 1);
}

Eigen::Matrix3Xd Square(int per_side) {
  return Polyline({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 0}}, per_side);
}

// Two legs a `width` apart, joined by a half circle.
Eigen::Matrix3Xd Horseshoe(int count, double width) {
  return AlongCurve(count, -1, 2, [&](double t) {
    if (t < 0) return Eigen::Vector3d(0.5 * width, 3 * t, 0);
    if (t > 1) return Eigen::Vector3d(-0.5 * width, 3 * (1 - t), 0);
    return Eigen::Vector3d(0.5 * width * OnCircle(std::numbers::pi * t));
  });
}

TEST(JudgeEndsTest, CallsARepeatedFirstPointClosed) {
  for (const Eigen::Matrix3Xd& points : {Airfoil(30, -0.1036), Square(20), Arc(50, 360)}) {
    const EndGap ends = JudgeEnds(points, 0);
    EXPECT_TRUE(ends.closed);
    EXPECT_TRUE(ends.repeated);
    EXPECT_NEAR(ends.gap, 0, kRounding);
  }
}

TEST(JudgeEndsTest, KeepsABluntTrailingEdgeOpen) {
  for (const int half : {8, 16, 30, 60}) {
    SCOPED_TRACE("points " + std::to_string(2 * half + 1));
    const EndGap ends = JudgeEnds(Airfoil(half, -0.1015), 0);
    EXPECT_FALSE(ends.closed);
    EXPECT_FALSE(ends.repeated);
    EXPECT_NEAR(ends.gap, 0.00252, 1e-5);  // twice the formula's half thickness at x = 1
  }
}

TEST(JudgeEndsTest, ClosesCirclesOfFewAndManyPoints) {
  for (const int count : {6, 8, 12, 13, 20, 100, 5000}) {
    SCOPED_TRACE("points " + std::to_string(count));
    const EndGap ends = JudgeEnds(Ellipse(count, 1, 1), 0);
    EXPECT_TRUE(ends.closed);
    EXPECT_FALSE(ends.repeated);
    EXPECT_NEAR(ends.gap, 2 * std::sin(std::numbers::pi / count), kRounding);
  }
}

TEST(JudgeEndsTest, ClosesEllipsesWhereverTheyBegin) {
  NoisyPoints random(3);
  for (int round = 0; round < 200; ++round) {
    const int count = random.Integer(20, 200);
    const double b = random.Real(0.4, 1), begin = random.Real(0, 7);
    SCOPED_TRACE("round " + std::to_string(round) + ", points " + std::to_string(count));
    EXPECT_TRUE(JudgeEnds(Ellipse(count, 1, b, begin), 0).closed);
  }
}

TEST(JudgeEndsTest, KeepsOpenCurvesOpen) {
  EXPECT_FALSE(JudgeEnds(Arc(100, 330), 0).closed);
  EXPECT_FALSE(JudgeEnds(Arc(5, 240), 0).closed);
  EXPECT_FALSE(JudgeEnds(Helix(2000), 1e-4).closed);
  EXPECT_FALSE(JudgeEnds(Helix(20000), 1e-4).closed);
  EXPECT_FALSE(
      JudgeEnds(AlongCurve(50, 0, 1, [](double t) { return Eigen::Vector3d(t, 2 * t, 0); }), 0)
          .closed);
  for (const int teeth : {2, 3, 4, 9}) {
    for (const int per_side : {1, 2, 10}) {
      SCOPED_TRACE(std::to_string(teeth) + " teeth, " + std::to_string(per_side));
      EXPECT_FALSE(JudgeEnds(Zigzag(teeth, per_side, 5), 0).closed);
    }
  }
  for (const double turns : {1.3, 2.1, 5.0}) EXPECT_FALSE(JudgeEnds(Spiral(300, turns), 0).closed);
}

TEST(JudgeEndsTest, KeepsAnArcOpenWhoseNoiseIsThickerThanItsSteps) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    NoisyPoints random(seed);
    const int count = random.Integer(100, 3000);
    EXPECT_FALSE(JudgeEnds(random.Scattered(Arc(count, 330), 0.05, 2), 0.05).closed);
  }
}

TEST(JudgeEndsTest, ClosesAFlowerWhoseNoiseIsThickerThanItsSteps) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    NoisyPoints random(seed);
    const int count = random.Integer(500, 20000);
    EXPECT_TRUE(JudgeEnds(random.Scattered(Flower(count), 5e-3, 2), 5e-3).closed);
  }
}

TEST(JudgeEndsTest, ClosesASquareOneStepFromItsFirstCorner) {
  for (const int per_side : {3, 5, 20, 100}) {
    SCOPED_TRACE("steps a side " + std::to_string(per_side));
    const EndGap ends = JudgeEnds(WithoutLast(Square(per_side)), 0);
    EXPECT_TRUE(ends.closed);
    EXPECT_FALSE(ends.repeated);
  }
}

TEST(JudgeEndsTest, KeepsEndsThatLieSideBySideOpen) {
  for (const int count : {30, 100, 1000}) {
    const double step = 7.0 / count;
    for (const double width : {0.2 * step, 0.5 * step, step, 2 * step, 5 * step}) {
      SCOPED_TRACE("points " + std::to_string(count) + ", width " + std::to_string(width));
      EXPECT_FALSE(JudgeEnds(Horseshoe(count, width), 0).closed);
    }
  }
}

TEST(JudgeEndsTest, DoesNotDependOnUnitsPlaceAttitudeOrDirection) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  const std::vector<Eigen::Matrix3Xd> curves = {Arc(100, 330),
                                                Ellipse(12, 1, 1),
                                                WithoutLast(Square(20)),
                                                Airfoil(16, -0.1015),
                                                Airfoil(16, -0.1036),
                                                Helix(300),
                                                Ellipse(40, 3, 1)};
  for (size_t c = 0; c < curves.size(); ++c) {
    const EndGap before = JudgeEnds(curves[c], 1e-6);
    for (const double scale : {1e-6, 1.0, 1e6}) {
      SCOPED_TRACE("curve " + std::to_string(c) + ", scale " + std::to_string(scale));
      const Eigen::Matrix3Xd moved =
          (scale * (turn * curves[c])).colwise() + Eigen::Vector3d(0, -50, 20) * scale;
      const EndGap after = JudgeEnds(moved, 1e-6 * scale);
      const EndGap back = JudgeEnds(moved.rowwise().reverse(), 1e-6 * scale);
      EXPECT_EQ(after.closed, before.closed);
      EXPECT_EQ(after.repeated, before.repeated);
      EXPECT_NEAR(after.gap, before.gap * scale, kIterated * scale);
      EXPECT_EQ(back.closed, before.closed);
      EXPECT_EQ(back.repeated, before.repeated);
    }
  }
}

TEST(JudgeEndsTest, SeesARepeatedPointFarFromTheOrigin) {
  Eigen::Matrix3Xd points = Airfoil(30, -0.1036);
  points.colwise() += Eigen::Vector3d(5e6, -4e6, 100);
  EXPECT_TRUE(JudgeEnds(points, 0).repeated);
}

TEST(JudgeEndsTest, CallsTooFewPointsOpen) {
  EXPECT_FALSE(JudgeEnds(Eigen::Matrix3Xd::Ones(3, 1), 0).closed);
  EXPECT_FALSE(JudgeEnds(Eigen::Matrix3Xd::Ones(3, 7), 0).closed);
  EXPECT_FALSE(JudgeEnds(Arc(2, 90), 0).closed);
  EXPECT_FALSE(JudgeEnds(Arc(3, 240), 0).closed);
  EXPECT_FALSE(JudgeEnds(Arc(4, 90), 0).closed);
}

TEST(JudgeEndsTest, RefusesNoPointsAndImpossibleNoise) {
  EXPECT_THROW(JudgeEnds(Eigen::Matrix3Xd(3, 0), 0), std::invalid_argument);
  EXPECT_THROW(JudgeEnds(Arc(9, 90), -1), std::invalid_argument);
  EXPECT_THROW(JudgeEnds(Arc(9, 90), std::numeric_limits<double>::quiet_NaN()),
               std::invalid_argument);
}

}  // namespace batten::internal::curve_closure_test
