// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "batten/geometry/arc_length.h"
#include "batten/geometry/foot_point.h"
#include "batten/geometry/make_curve.h"
#include "batten/geometry/offset_curve.h"
#include "random_splines.h"
#include "refusal.h"
#include "tolerances.h"

namespace batten::internal::offset_curve_test {

NurbsCurve<2> Wave(double height) {
  Eigen::Matrix2Xd points(2, 8);
  points << 0, 1, 2, 3, 4, 5, 6, 7, 0, height, -height, height, -height, height, -height, 0;
  return NurbsCurve<2>(SplineBasis::Uniform(3, 8, 0, 1), points);
}

// The offset C + d·W itself, at the curve's parameter.
Eigen::Vector2d ExactAt(const NurbsCurve<2>& curve, double d, double u) {
  const CurveJet<2> jet = curve.JetAt(u);
  return jet.point + d * Eigen::Vector2d(-jet.first[1], jet.first[0]).normalized();
}

TEST(OffsetCurveTest, KeepsTheToleranceBetweenSamples) {
  const NurbsCurve<2> wave = Wave(0.7);
  for (const double tolerance : {1e-3, 1e-6, 1e-9}) {
    for (const double d : {0.1, -0.2}) {
      const CurveOffset<2> offset = OffsetCurve(wave, d, {.tolerance = tolerance});
      EXPECT_FALSE(offset.exact);
      for (int k = 0; k <= 9973; ++k) {
        const double u = k / 9973.0;
        ASSERT_LE((offset.curve.At(u) - ExactAt(wave, d, u)).norm(), tolerance) << u;
      }
    }
  }
}

TEST(OffsetCurveTest, LinesAndCirclesStayWhatTheyAre) {
  const auto circle = MakeArc(Eigen::Vector2d(1, 2), 3.0);
  const CurveOffset<2> inside = OffsetCurve(circle, 0.5);
  EXPECT_TRUE(inside.exact);
  EXPECT_EQ(inside.curve.weights(), circle.weights());
  for (int k = 0; k <= 100; ++k) {
    EXPECT_NEAR((inside.curve.At(k / 100.0) - Eigen::Vector2d(1, 2)).norm(), 2.5, 3 * kRounding);
  }
  const auto line = MakeLine<2>({0, 0}, {3, 4});
  const CurveOffset<2> beside = OffsetCurve(line, 5);
  EXPECT_TRUE(beside.exact);
  EXPECT_LE((beside.curve.At(0) - Eigen::Vector2d(-4, 3)).norm(), 4 * kRounding);
}

TEST(OffsetCurveTest, ADistanceBeyondTheRadiusNamesRadiusAndPlace) {
  const auto circle = MakeArc(Eigen::Vector2d(1, 2), 3.0);
  EXPECT_NO_THROW(OffsetCurve(circle, -3.5));
  try {
    OffsetCurve(circle, 3.5);
    FAIL();
  } catch (const std::invalid_argument& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("smallest radius of curvature 3 "),
              std::string::npos)
        << refusal.what();
  }
  EXPECT_THROW(OffsetCurve(circle, 0), std::invalid_argument);
  EXPECT_THROW(OffsetCurve(circle, NAN), std::invalid_argument);
  EXPECT_THROW(OffsetCurve(circle, 1, {.tolerance = -1.0}), std::invalid_argument);
}

TEST(OffsetCurveTest, ASquareGetsRoundCornersOutsideAndLosesItsLoopsInside) {
  Eigen::Matrix2Xd points(2, 5);
  points << 0, 1, 1, 0, 0, 0, 0, 1, 1, 0;
  const NurbsCurve<2> square(SplineBasis(1, {0, 0, 1, 2, 3, 4, 4}), points);
  const CurveOffset<2> outside = OffsetCurve(square, -0.1);
  EXPECT_TRUE(outside.self_meetings.empty());
  EXPECT_NEAR(ArcLength(outside.curve), 4 + 0.2 * 3.141592653589793, 1e-5);
  const CurveOffset<2> inside = OffsetCurve(square, 0.1);
  EXPECT_EQ(inside.self_meetings.size(), 4u);
  const auto kept = WithoutLoops(inside, square, 0.1);
  ASSERT_EQ(kept.size(), 1u);
  EXPECT_NEAR(ArcLength(kept[0]), 3.2, 1e-5);
}

// What is left is nowhere nearer than the distance, and reaches it everywhere.
TEST(OffsetCurveTest, WithoutLoopsIsAsFarAsTheDistanceEverywhere) {
  Eigen::Matrix2Xd points(2, 7);
  points << 0, 1.3, -1.5, 1, 3.5, 0.7, 2, 5, 3, -1, -3, -1, 3, 5;
  const NurbsCurve<2> bottle(SplineBasis::Uniform(3, 7, 0, 1), points);
  constexpr double kDistance = 0.55, kTolerance = 1e-6;
  const CurveOffset<2> offset = OffsetCurve(bottle, kDistance, {.tolerance = kTolerance});
  EXPECT_FALSE(offset.self_meetings.empty());
  const auto kept = WithoutLoops(offset, bottle, kDistance, {.tolerance = kTolerance});
  ASSERT_FALSE(kept.empty());
  const CurveFootPoints<2> feet(bottle);
  for (const NurbsCurve<2>& part : kept) {
    const double from = part.basis().lower(), to = part.basis().upper();
    for (int k = 0; k <= 500; ++k) {
      const Eigen::Vector2d at = part.At(from + k * (to - from) / 500);
      EXPECT_NEAR(feet.Nearest({at[0], at[1], 0}).distance, kDistance, 10 * kTolerance);
    }
  }
}

TEST(OffsetCurveTest, ASpaceCurveGoesAsideInThePlaneAcrossTheNormal) {
  const auto circle = MakeArc(Frame({5e6, 5e6, 10}, {0, 0, 1}), 3.0);
  const CurveOffset<3> wide = OffsetCurve(circle, Eigen::Vector3d(0, 0, 2), -1);
  EXPECT_TRUE(wide.exact);
  EXPECT_NEAR((wide.curve.At(0.3) - Eigen::Vector3d(5e6, 5e6, 10)).norm(), 4, 1e-8);
  EXPECT_THROW(OffsetCurve(MakeLine<3>({0, 0, 0}, {0, 0, 1}), Eigen::Vector3d::UnitZ(), 1),
               std::invalid_argument);
}

}  // namespace batten::internal::offset_curve_test
