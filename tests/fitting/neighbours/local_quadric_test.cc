// SPDX-License-Identifier: MIT
#include "fitting/neighbours/local_quadric.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <string>

#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::local_quadric_test {

// Heights of a random gentle quadric over the unit square, turned and moved with the frame.
struct Sheet {
  explicit Sheet(unsigned seed) : random(seed) {
    frame = Eigen::Quaterniond(
                random.Real(-1, 1), random.Real(-1, 1), random.Real(-1, 1), random.Real(-1, 1))
                .normalized()
                .toRotationMatrix();
    for (double& b : bend) b = random.Real(-0.05, 0.05);
  }
  Eigen::Vector3d Point(double x, double y, double off = 0) const {
    return frame * Eigen::Vector3d(x, y, bend[0] * x * x + bend[1] * x * y + bend[2] * y * y + off);
  }
  Eigen::Matrix3Xd Points(int count) {
    Eigen::Matrix3Xd points(3, count);
    for (auto p : points.colwise()) p = Point(random.Real(-1, 1), random.Real(-1, 1));
    return points;
  }
  RandomSplines random;
  Eigen::Matrix3d frame;
  double bend[3];
};

TEST(LocalQuadricTest, FollowsAGentleQuadric) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Sheet sheet(seed);
    const Eigen::Matrix3Xd points = sheet.Points(30);
    for (const LocalQuadric& quadric : {LocalQuadric(points), LocalQuadric::MostAgreeOn(points)}) {
      // The frame is that of the points' plane, tilted by a few percent against the quadric's own:
      // its heights there are no quadric by the bend times the tilt squared.
      EXPECT_LT(quadric.deviation(), 1e-3);
      EXPECT_NEAR(std::abs(quadric.Offset(sheet.Point(0.2, 0.1, 0.3))), 0.3, 0.01);
    }
  }
}

TEST(LocalQuadricTest, IsNotMovedByAFifthOfGrossErrors) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Sheet sheet(seed);
    Eigen::Matrix3Xd points = sheet.Points(40);
    for (int k = 0; k < 8; ++k) {
      points.col(k) = sheet.Point(
          sheet.random.Real(-1, 1), sheet.random.Real(-1, 1), sheet.random.Real(0.5, 1));
    }
    EXPECT_LT(std::abs(LocalQuadric::MostAgreeOn(points).Offset(sheet.Point(0, 0))), 0.05);
  }
}

TEST(LocalQuadricTest, HasLeveragesThatSumToItsFreedom) {
  Sheet sheet(1);
  const Eigen::Matrix3Xd points = sheet.Points(30);
  const LocalQuadric quadric(points);
  double sum = 0;
  for (const auto& p : points.colwise()) sum += quadric.Leverage(p);
  EXPECT_NEAR(sum, 6, kHalfDigits);
  EXPECT_GT(quadric.Leverage(sheet.Point(4, 4)), 10);
}

TEST(LocalQuadricTest, ScalesWithTheUnit) {
  Sheet sheet(2);
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal(0, 0.01);
  Eigen::Matrix3Xd points = sheet.Points(30);
  for (double& x : points.reshaped()) x += normal(engine);
  const LocalQuadric one = LocalQuadric::MostAgreeOn(points);
  for (const double unit : {0x1p-20, 0x1p20}) {
    const LocalQuadric other = LocalQuadric::MostAgreeOn(unit * points);
    EXPECT_NEAR(other.deviation(), unit * one.deviation(), kHalfDigits * unit);
    EXPECT_NEAR(other.robust_scale(), unit * one.robust_scale(), kHalfDigits * unit);
    EXPECT_NEAR(other.scale_of_most(), unit * one.scale_of_most(), kHalfDigits * unit);
  }
}

TEST(LocalQuadricTest, OverAPlaneIsLinearInTheHeightsHoweverLarge) {
  std::mt19937_64 engine(4);
  std::normal_distribution<double> normal;
  Sheet sheet(4);
  Eigen::Matrix3Xd points(3, 40);
  for (double& x : points.reshaped()) x = normal(engine);
  const Eigen::VectorXd heights = points.row(2).transpose();
  const auto raised = [&](double factor) -> Eigen::Matrix3Xd {
    Eigen::Matrix3Xd local = points;
    local.row(2) = factor * heights.transpose();
    return sheet.frame * local;
  };
  const LocalPlane plane{sheet.frame * points.rowwise().mean(), sheet.frame.col(2)};
  const double deviation = LocalQuadric::Over(plane, raised(1)).deviation();
  EXPECT_GT(deviation, 0.5);
  for (const double factor : {1e-9, 1e-3, 10.0, 1e9}) {
    SCOPED_TRACE("factor " + std::to_string(factor));
    EXPECT_NEAR(
        LocalQuadric::Over(plane, raised(factor)).deviation() / factor, deviation, kHalfDigits);
  }
}

TEST(LocalQuadricTest, TakesPointsOnALineAndInOnePlace) {
  Eigen::Matrix3Xd line = Eigen::Matrix3Xd::Zero(3, 12);
  EXPECT_TRUE(std::isfinite(LocalQuadric::MostAgreeOn(line).Offset(Eigen::Vector3d::Ones())));
  line.row(0).setLinSpaced(0, 1);
  EXPECT_NEAR(LocalQuadric(line).deviation(), 0, kHalfDigits);
  EXPECT_TRUE(std::isfinite(LocalQuadric(line).Leverage(Eigen::Vector3d(0.5, 0, 0))));
}

}  // namespace batten::internal::local_quadric_test
