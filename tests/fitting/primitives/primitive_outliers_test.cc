// SPDX-License-Identifier: MIT
// Lines and circles in spite of outliers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <variant>

#include "cases.h"
#include "primitive_clouds.h"
#include "tolerances.h"

namespace batten::internal::primitive_outliers_test {

// Outliers anywhere in a box twice as wide as the shape.
Eigen::Matrix3Xd WithOutliers(Eigen::Matrix3Xd points,
                              double share,
                              RandomSplines& random,
                              bool plane) {
  const Eigen::Vector3d middle = (points.rowwise().minCoeff() + points.rowwise().maxCoeff()) / 2;
  const double half = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).maxCoeff();
  const int bad = static_cast<int>(share * static_cast<double>(points.cols()));
  for (int k = 0; k < bad; ++k) {
    auto p = points.col(random.Integer(0, static_cast<int>(points.cols()) - 1));
    p = middle + random.Vector(half);
    if (plane) p.z() = 0;
  }
  return points;
}

// Off the truth: the largest distance of the true points from the shape.
double OffTruth(const PrimitiveFit& fit, const Eigen::Matrix3Xd& truth) {
  return std::visit(
      [&](const auto& shape) {
        double squares = 0;
        for (const auto& p : truth.colwise()) squares += std::pow(DistanceTo(shape, p), 2);
        return std::sqrt(squares / static_cast<double>(truth.cols()));
      },
      fit.shape);
}

// The rms distance of the truth from the fit against that of plain fits to the same points without
// outliers.
void ExpectRobust(Loss loss, double share, double factor, int trials) {
  RandomSplines random(8);
  Noise noise(8);
  for (const bool plane : {true, false}) {
    for (const bool bent : {true, false}) {
      double clean_squares = 0, dirty_squares = 0;
      for (int trial = 0; trial < trials; ++trial) {
        SCOPED_TRACE("seed 8, trial " + std::to_string(trial));
        const double sweep = random.Real(60, 360) * kDegree;
        const Eigen::Matrix3Xd truth =
            RandomPlace(random, plane, 3)(bent ? ArcPoints(500, sweep) : LinePoints(500, 1));
        Eigen::Matrix3Xd points = truth;
        noise.AddTo(points, 0.005, plane);
        const PrimitiveKind kind = bent ? PrimitiveKind::kCircle : PrimitiveKind::kLine;
        clean_squares +=
            std::pow(OffTruth(FitPrimitive(Cloud(points, plane), Options(kind)), truth), 2);
        points = WithOutliers(points, share, random, plane);
        const PrimitiveFit fit =
            FitPrimitive(Cloud(points, plane), Options(PrimitiveKind::kAuto, loss));
        ASSERT_EQ(fit.report.geometry.base, bent ? "circle" : "line")
            << fit.report.geometry.primitive->why;
        dirty_squares += std::pow(OffTruth(fit, truth), 2);
        // An outlier less than six usual windows from the end may stretch the arc.
        if (bent && sweep < 240 * kDegree) {
          const double windows = 6 * 4 * sweep / ((1 - share) * 500);
          EXPECT_GT(*fit.report.geometry.primitive->sweep, 0.97 * sweep);
          EXPECT_LT(*fit.report.geometry.primitive->sweep, sweep + 2 * windows);
        }
      }
      EXPECT_LT(std::sqrt(dirty_squares), factor * std::sqrt(clean_squares))
          << (bent ? "circle" : "line") << (plane ? " in the plane" : " in space");
    }
  }
}

TEST(PrimitiveOutliersTest, BearsOutliers) { ExpectRobust(Loss::kTukey, 0.3, 1.5, Cases(20)); }

TEST(LongPrimitiveOutliersTest, ThirtyPercentOfOutliersCostLittleUnderEveryLoss) {
  for (const Loss loss : {Loss::kTukey, Loss::kHuber, Loss::kCauchy}) {
    ExpectRobust(loss, 0.3, 1.5, 60);
  }
}

TEST(LongPrimitiveOutliersTest, NearlyHalfMayBeOutliers) {
  ExpectRobust(Loss::kTukey, 0.45, 2, 60);
}

TEST(PrimitiveOutliersTest, BearsOutliersAmongExactPoints) {
  RandomSplines random(9);
  for (int trial = 0; trial < 10; ++trial) {
    SCOPED_TRACE("seed 9, trial " + std::to_string(trial));
    const bool plane = random.Coin();
    const Eigen::Matrix3Xd points =
        WithOutliers(ArcPoints(60, random.Real(1, 5)), 0.3, random, plane);
    const PrimitiveFit fit =
        FitPrimitive(Cloud(points, plane), Options(PrimitiveKind::kAuto, Loss::kTukey));
    const CircleShape& circle = std::get<CircleShape>(fit.shape);
    EXPECT_NEAR(circle.radius, 1, kIterated);
    EXPECT_LT(circle.center.norm(), kIterated);
    EXPECT_GT(fit.report.input.outliers, 5);
  }
  Eigen::Matrix3Xd grid = LinePoints(21, 20);  // whole numbers: most distances are zero
  grid.row(1).segment(3, 4).setConstant(5);
  const PrimitiveFit fit =
      FitPrimitive(Cloud(grid, true), Options(PrimitiveKind::kAuto, Loss::kHuber));
  EXPECT_LT(std::get<LineShape>(fit.shape).point.y(), kIterated);
  EXPECT_EQ(fit.report.input.outliers, 4);
}

}  // namespace batten::internal::primitive_outliers_test
