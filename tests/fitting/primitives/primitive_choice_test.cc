// SPDX-License-Identifier: MIT
// Which primitive, how much of it, and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <variant>

#include "cases.h"
#include "primitive_clouds.h"
#include "tolerances.h"

namespace batten::internal::primitive_choice_test {

using ::testing::HasSubstr;

// Noise rarely passes for a bend, and a bend twice as high as noise hides is seen.
TEST(PrimitiveChoiceTest, ChoosesTheSimplestThatThePointsDoNotReject) {
  RandomSplines random(10);
  Noise noise(10);
  int wrong = 0, missed = 0;
  const int trials = Cases(100);
  for (int trial = 0; trial < trials; ++trial) {
    const bool plane = random.Coin();
    const int count = random.Integer(4, 200);
    Eigen::Matrix3Xd points = LinePoints(count, 1);
    noise.AddTo(points, 0.01, plane);
    const PrimitiveFit fit = FitPrimitive(Cloud(points, plane));
    if (!std::holds_alternative<LineShape>(fit.shape)) ++wrong;
    EXPECT_THAT(fit.report.geometry.primitive->why, HasSubstr("noise"));

    const double sweep = random.Real(20, 360) * kDegree;
    Eigen::Matrix3Xd arc = ArcPoints(20 + count, sweep);
    noise.AddTo(arc, 0.2 * (1 - std::cos(sweep / 2)), plane);
    if (std::holds_alternative<LineShape>(FitPrimitive(Cloud(arc, plane)).shape)) ++missed;
  }
  EXPECT_LE(wrong, trials * 3 / 100);
  EXPECT_LE(missed, trials / 100);
}

TEST(PrimitiveChoiceTest, WarnsWhereTheRadiusMeansLittle) {
  Noise noise(11);
  Eigen::Matrix3Xd points = LinePoints(100, 1);
  noise.AddTo(points, 0.01, false);
  const PrimitiveFit fit = FitPrimitive(Cloud(points, false), Options(PrimitiveKind::kCircle));
  ASSERT_EQ(fit.report.warnings.size(), 1u);
  EXPECT_THAT(fit.report.warnings.front(), HasSubstr("radius means little"));
}

TEST(PrimitiveChoiceTest, CoversWhatThePointsCover) {
  const auto sweep_of = [](const Eigen::Matrix3Xd& points) {
    const PrimitiveFit fit = FitPrimitive(Cloud(points, true), Options(PrimitiveKind::kCircle));
    const PrimitiveSummary& primitive = *fit.report.geometry.primitive;
    EXPECT_EQ(fit.report.geometry.closed[0], *primitive.sweep > 359.9 * kDegree);
    const auto& curve = std::get<NurbsCurve<2>>(fit.geometry);
    const double gap =
        (curve.control_points().rightCols<1>() - curve.control_points().col(0)).norm();
    EXPECT_EQ(fit.report.geometry.closed[0], gap == 0);
    return *primitive.sweep / kDegree;
  };
  for (const double sweep : {1.0, 5.0, 89.0, 90.0, 91.0, 180.0, 270.0, 299.0}) {
    EXPECT_NEAR(sweep_of(ArcPoints(100, sweep * kDegree, 2)), sweep, 1e-6 * sweep);
  }
  EXPECT_NEAR(sweep_of(ArcPoints(100, 301 * kDegree, 2)), 360, kIterated);
  for (const int count : {3, 4, 5, 6}) {  // a regular polygon's corners go all round
    const double step = 360.0 / count;
    EXPECT_NEAR(sweep_of(ArcPoints(count, (360 - step) * kDegree)), 360, kIterated);
  }
  EXPECT_NEAR(sweep_of(ArcPoints(3, 200 * kDegree)), 200, kIterated);
}

TEST(PrimitiveChoiceTest, RunsTheWayThePointsRun) {
  for (const bool reversed : {false, true}) {
    Eigen::Matrix3Xd arc = ArcPoints(50, 4), segment = LinePoints(9, 1);
    if (reversed) {
      arc = arc.rowwise().reverse().eval();
      segment = segment.rowwise().reverse().eval();
    }
    const double sign = reversed ? -1 : 1;
    const PrimitiveFit circle = FitPrimitive(Cloud(arc, false));
    EXPECT_NEAR(std::get<CircleShape>(circle.shape).normal.z(), sign, kRounding);
    const auto& curve = std::get<NurbsCurve<3>>(circle.geometry);
    EXPECT_LT((curve.At(0) - arc.col(0)).norm(), kIterated);
    const PrimitiveFit line = FitPrimitive(Cloud(segment, false));
    EXPECT_NEAR(std::get<LineShape>(line.shape).direction.x(), sign, kRounding);
    const PrimitiveFit plane = FitPrimitive(Cloud(arc, true));
    EXPECT_GT(std::get<CircleShape>(plane.shape).normal.z(), 0);
  }
}

// A degenerate start: full circles and lines in special attitudes, few points, two clusters.
TEST(PrimitiveChoiceTest, BearsOddClouds) {
  for (int count = 3; count < 12; ++count) {
    const Eigen::Matrix3Xd points = ArcPoints(count, 2 * std::numbers::pi * (count - 1) / count);
    for (const bool plane : {true, false}) {
      for (const std::optional<Loss> loss :
           {Loss::kNone, Loss::kHuber, Loss::kCauchy, Loss::kTukey}) {
        const PrimitiveFit fit =
            FitPrimitive(Cloud(points, plane), Options(PrimitiveKind::kCircle, loss));
        EXPECT_NEAR(std::get<CircleShape>(fit.shape).radius, 1, kIterated);
      }
    }
  }
  Eigen::Matrix3Xd clusters(3, 40);
  Noise noise(12);
  for (int k = 0; k < 40; ++k) clusters.col(k) << k % 2, 0, 0;
  noise.AddTo(clusters, 1e-3, false);
  const PrimitiveFit fit = FitPrimitive(Cloud(clusters, false));
  EXPECT_LT(fit.residuals.maxCoeff(), 0.01);
}

// Few points on a small grid: repeated, on one line, on two places, at corners of a square.
TEST(PrimitiveChoiceTest, AnswersOrRefusesEveryTinyCloud) {
  RandomSplines random(16);
  int answered = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    SCOPED_TRACE("seed 16, trial " + std::to_string(trial));
    const bool plane = random.Coin();
    Eigen::Matrix3Xd points(3, random.Integer(1, 7));
    for (double& x : points.reshaped()) x = random.Integer(0, 2);
    if (plane) points.row(2).setZero();
    const double scale = random.Logarithmic(1e-80, 1e80);
    points *= scale;
    if (random.Coin()) points.colwise() += Eigen::Vector3d(5e6, 7e6, 0) * scale;
    for (const PrimitiveKind kind :
         {PrimitiveKind::kAuto, PrimitiveKind::kLine, PrimitiveKind::kCircle}) {
      const Loss losses[] = {Loss::kNone, Loss::kHuber, Loss::kCauchy, Loss::kTukey};
      PrimitiveFitOptions options = Options(kind, losses[random.Integer(0, 3)]);
      options.threads = 1;
      if (random.Coin()) options.loss_scale = scale * random.Logarithmic(1e-9, 10);
      try {
        const PrimitiveFit fit = FitPrimitive(Cloud(points, plane), options);
        ++answered;
        EXPECT_TRUE(fit.residuals.allFinite());
        EXPECT_EQ(fit.residuals.size(), points.cols());
        EXPECT_LT(OffShape(fit),
                  1e-6 * (scale + fit.report.geometry.primitive->radius.value_or(0)));
      } catch (const std::invalid_argument& error) {
        EXPECT_GT(std::string(error.what()).size(), 10u);
      }
    }
  }
  EXPECT_GT(answered, 2000);
}

void ExpectRefused(const Eigen::Matrix3Xd& points, PrimitiveKind kind, const std::string& reason) {
  try {
    FitPrimitive(Cloud(points, false), Options(kind));
    ADD_FAILURE() << "not refused: " << reason;
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr(reason));
  }
}

TEST(PrimitiveChoiceTest, RefusesWhatDeterminesNothing) {
  using Points = Eigen::Matrix3Xd;
  ExpectRefused(Points(3, 0), PrimitiveKind::kAuto, "no points");
  ExpectRefused(Points::Ones(3, 9), PrimitiveKind::kLine, "at least 2 different points");
  Points two = Points::Ones(3, 9);
  two(0, 3) = 2;
  ExpectRefused(two, PrimitiveKind::kCircle, "at least 3 different points");
  RandomSplines random(15);
  for (int trial = 0; trial < 100; ++trial) {
    const Points line = RandomPlace(random, false, 1e3)(LinePoints(random.Integer(3, 50), 1));
    ExpectRefused(line, PrimitiveKind::kCircle, "collinear");
    EXPECT_TRUE(std::holds_alternative<LineShape>(FitPrimitive(Cloud(line, false)).shape));
  }
  PrimitiveFitOptions options;
  options.tolerance = 0;
  EXPECT_THROW(FitPrimitive(Cloud(two, false), options), std::invalid_argument);
  options = {};
  options.loss_scale = -1;
  EXPECT_THROW(FitPrimitive(Cloud(two, false), options), std::invalid_argument);
  options = {};
  options.progress = [](const char*, double) { return false; };
  EXPECT_THROW(FitPrimitive(Cloud(two, false), options), Cancelled);
}

}  // namespace batten::internal::primitive_choice_test
