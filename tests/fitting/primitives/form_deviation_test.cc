// SPDX-License-Identifier: MIT
#include "batten/fitting/form_deviation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "batten/fitting/fit_primitive.h"
#include "tolerances.h"

namespace batten {
namespace {

using internal::kHalfDigits;
constexpr double kPi = std::numbers::pi;

FormDeviation FormOf(const Eigen::Matrix3Xd& points, PrimitiveKind kind) {
  const PointCloud cloud = PointCloud::FromWorld(points);
  PrimitiveFitOptions options;
  options.kind = kind;
  options.loss = Loss::kNone;
  options.threads = 1;
  return FormDeviationOf(FitPrimitive(cloud, options), cloud);
}

// Bumps that alternate about the true form cannot be told from a narrower zone: the minimum zone is
// their width, wherever the form lies.
TEST(FormDeviationTest, ZoneOfAlternatingBumpsIsTheirWidth) {
  const Eigen::AngleAxisd turn(0.7, Eigen::Vector3d(1, 2, 3).normalized());
  for (const Eigen::Vector3d& far : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(5e5, 5e6, 200)}) {
    Eigen::Matrix3Xd plane(3, 400), ring(3, 360), pipe(3, 1200);
    for (int k = 0; k < 400; ++k)
      plane.col(k) << k / 20, k % 20, 0.01 * ((k / 20 + k % 20) % 2 ? 1 : -1);
    for (int k = 0; k < 360; ++k) {
      const double a = 2 * kPi * k / 360, r = 10 + 0.02 * std::cos(6 * a);
      ring.col(k) << r * std::cos(a), r * std::sin(a), 0;
    }
    for (int k = 0; k < 1200; ++k) {
      const double a = 2 * kPi * (k % 60) / 60, r = 10 + 0.02 * std::cos(6 * a);
      pipe.col(k) << r * std::cos(a), r * std::sin(a), k / 60;
    }
    const auto placed = [&](const Eigen::Matrix3Xd& points) -> Eigen::Matrix3Xd {
      return (turn.toRotationMatrix() * points).colwise() + far;
    };
    EXPECT_NEAR(FormOf(placed(plane), PrimitiveKind::kPlane).minimum_zone, 0.02, kHalfDigits);
    EXPECT_NEAR(FormOf(placed(ring), PrimitiveKind::kCircle).minimum_zone, 0.04, kHalfDigits);
    EXPECT_NEAR(FormOf(placed(pipe), PrimitiveKind::kCylinder).minimum_zone, 0.04, kHalfDigits);
  }
}

// No shape near the minimum zone's has a narrower one: many random shapes are tried.
TEST(FormDeviationTest, MinimumZoneIsBelowLeastSquaresAndAboveNothingTried) {
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> even(0, 1);
  Eigen::Matrix3Xd points(3, 60);
  for (int k = 0; k < 60; ++k) {
    const double a = 2 * kPi * even(random), r = 5 + 0.05 * normal(random);
    points.col(k) << r * std::cos(a), r * std::sin(a), 0;
  }
  const FormDeviation form = FormOf(points, PrimitiveKind::kCircle);
  EXPECT_LT(form.minimum_zone, form.least_squares);
  double least = form.least_squares;
  for (int run = 0; run < 20000; ++run) {
    const Eigen::Vector3d center(0.1 * (even(random) - 0.5), 0.1 * (even(random) - 0.5), 0);
    const Eigen::VectorXd d = (points.colwise() - center).topRows<2>().colwise().norm();
    least = std::min(least, d.maxCoeff() - d.minCoeff());
  }
  EXPECT_LE(form.minimum_zone, least * (1 + 1e-6));  // of the circle's plane, found by the fit
}

TEST(FormDeviationTest, IsOfPlanesCirclesSpheresAndCylindersOnly) {
  Eigen::Matrix3Xd line(3, 10);
  for (int k = 0; k < 10; ++k) line.col(k) << k, 2 * k, 0.01 * (k % 3);
  const PointCloud cloud(line);
  PrimitiveFitOptions options;
  options.kind = PrimitiveKind::kLine;
  const PrimitiveFit fit = FitPrimitive(cloud, options);
  EXPECT_FALSE(HasForm(fit));
  EXPECT_THROW(FormDeviationOf(fit, cloud), std::invalid_argument);
}

}  // namespace
}  // namespace batten
