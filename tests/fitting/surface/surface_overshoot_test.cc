// SPDX-License-Identifier: MIT
#include "fitting/surface/surface_overshoot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>

#include "batten/fitting/fit_report.h"
#include "batten/fitting/fit_surface.h"
#include "batten/geometry/surface_evaluator.h"

namespace batten::internal::surface_overshoot_test {

constexpr double kSpacing = 0.02;

// Points on the unit square at z = 0 but for a hole of a radius about (0.5, 0.5).
Eigen::Matrix2Xd PlacesRoundAHole(double radius, unsigned seed = 1) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> uniform;
  Eigen::Matrix2Xd places(2, 2500);
  for (Eigen::Index k = 0; k < places.cols();) {
    const Eigen::Vector2d place(uniform(engine), uniform(engine));
    if ((place - Eigen::Vector2d(0.5, 0.5)).norm() >= radius) places.col(k++) = place;
  }
  return places;
}

Eigen::Matrix3Xd AtZero(const Eigen::Matrix2Xd& places) {
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, places.cols());
  points.topRows<2>() = places;
  return points;
}

// The unit square with a hump in the middle, whose height is `height` at (0.5, 0.5).
NurbsSurface Hump(double height) {
  const SplineBasis basis = SplineBasis::Uniform(3, 23, 0, 1);
  Eigen::Matrix3Xd net(3, 23 * 23);
  for (int i = 0; i < 23; ++i)
    for (int j = 0; j < 23; ++j)
      net.col(i * 23 + j) << basis.Greville(i), basis.Greville(j),
          i == 11 && j == 11 ? height * 9 / 4 : 0;  // a function of both is 4/9 at its middle
  return NurbsSurface(basis, basis, net);
}

OvershootSummary Measured(const NurbsSurface& surface, double radius) {
  const Eigen::Matrix2Xd feet = PlacesRoundAHole(radius);
  ThreadPool pool(2);
  return MeasureOvershoot({surface, AtZero(feet), feet, kSpacing}, pool);
}

TEST(MeasureOvershootTest, FindsAHumpInAHole) {
  for (const double height : {-0.3, 0.1, 1.0, 50.0}) {
    SCOPED_TRACE(height);
    const OvershootSummary found = Measured(Hump(height), 0.2);
    EXPECT_NEAR(found.max, std::abs(height), 0.05 * std::abs(height));
    EXPECT_NEAR(found.in_spacings, found.max / kSpacing, 1e-9 * found.in_spacings);
    EXPECT_LT((found.at.head<2>() - Eigen::Vector2d(0.5, 0.5)).norm(), 0.03);
    EXPECT_NEAR(found.at[2], height, 0.05 * std::abs(height));
  }
}

TEST(MeasureOvershootTest, MeasuresHolesWithoutOvershoot) {
  const OvershootSummary found = Measured(Hump(0), 0.2);
  EXPECT_EQ(found.max, 0);
  EXPECT_NEAR(found.area_without_points, std::numbers::pi * 0.2 * 0.2, 0.02);
  EXPECT_NEAR(found.share_without_points, found.area_without_points, 1e-6);
  EXPECT_NEAR(found.largest_gap, 0.2, 0.03);
}

TEST(MeasureOvershootTest, IsZeroAmongPoints) {
  const OvershootSummary found = Measured(Hump(0), 0);
  EXPECT_EQ(found.max, 0);
  EXPECT_EQ(found.area_without_points, 0);
}

// Heights that points nearby have are no overshoot: a slope of 45 degrees across the hole.
TEST(MeasureOvershootTest, AllowsTheHeightsNearby) {
  const Eigen::Matrix2Xd feet = PlacesRoundAHole(0.2);
  Eigen::Matrix3Xd points = AtZero(feet);
  points.row(2) = points.row(0);
  const SplineBasis basis = SplineBasis::Uniform(3, 23, 0, 1);
  Eigen::Matrix3Xd net(3, 23 * 23);
  for (int i = 0; i < 23; ++i)
    for (int j = 0; j < 23; ++j)
      net.col(i * 23 + j) << basis.Greville(i), basis.Greville(j), basis.Greville(i);
  ThreadPool pool(1);
  const NurbsSurface slope(basis, basis, net);
  EXPECT_LT(MeasureOvershoot({slope, points, feet, kSpacing, Eigen::Vector3d(0, 0, 1)}, pool).max,
            1e-9);
  EXPECT_LT(MeasureOvershoot({slope, points, feet, kSpacing}, pool).max, 0.1 * kSpacing);
}

TEST(FitReportTest, WhatLeavesItsPointsMissesTheTolerance) {
  FitReport report;
  report.error.tolerance = 1.0;
  EXPECT_TRUE(*report.tolerance_reached());
  report.overshoot = OvershootSummary{.max = 1.01, .in_spacings = 3.1};
  EXPECT_TRUE(report.leaves_points());
  EXPECT_FALSE(*report.tolerance_reached());
  report.error.max = 1.1;  // the points say as much
  EXPECT_FALSE(report.leaves_points());
  report.error.max = 0;
  report.overshoot->asked_for = true;  // the whole rectangle
  EXPECT_FALSE(report.leaves_points());
  report.overshoot->asked_for = false;
  report.overshoot->in_spacings = 2.9;
  EXPECT_FALSE(report.leaves_points());
}

// By how many diagonals a surface leaves a box, on a grid of places.
double OutOfBox(const NurbsSurface& surface, const Eigen::AlignedBox3d& box) {
  constexpr int kPlaces = 400;
  const SurfaceEvaluator evaluator(surface);
  const auto at = [](const SplineBasis& basis, int k) {
    return basis.lower() + (basis.upper() - basis.lower()) * k / kPlaces;
  };
  double most = 0;
  for (int i = 0; i <= kPlaces; ++i) {
    for (int j = 0; j <= kPlaces; ++j) {
      const Eigen::Vector3d place =
          evaluator.At(at(surface.basis_u(), i), at(surface.basis_v(), j));
      most = std::max(most, (box.min() - place).cwiseMax(place - box.max()).cwiseMax(0).norm());
    }
  }
  return most / box.diagonal().norm();
}

// Few points round a tube, with noise that the tolerance does not allow; nothing if they are
// refused.
std::optional<SurfaceFit> FitOfFewPoints(unsigned seed, Trimming trim) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> even(0, 1);
  std::normal_distribution<double> normal(0, 0.3);
  Eigen::Matrix3Xd points(3, 12 + static_cast<Eigen::Index>(seed % 12));
  for (auto point : points.colwise()) {
    const double angle = 2 * std::numbers::pi * even(engine);
    point << 2 * std::cos(angle), 2 * std::sin(angle), 6 * even(engine);
    for (double& x : point) x += normal(engine);
  }
  SurfaceFitOptions options;
  options.tolerance = 1e-9;
  options.trim = trim;
  options.threads = 1;
  try {
    return FitSurface(PointCloud::FromWorld(points), options);
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

TEST(FitSurfaceOvershootTest, SurfacesThatLeaveTheBoxOfTheirPointsAreTold) {
  int told = 0, fitted = 0;
  for (unsigned seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const bool asked_for = seed % 2 == 0;
    const auto fit = FitOfFewPoints(seed, asked_for ? Trimming::kNone : Trimming::kAuto);
    if (!fit || fit->surface.trimmed()) continue;
    ++fitted;
    Eigen::AlignedBox3d box(fit->report.input.box_min, fit->report.input.box_max);
    const double out = OutOfBox(fit->surface, box);
    if (out < 0.52) continue;  // half a diagonal, and what the places miss
    ++told;
    EXPECT_EQ(fit->report.leaves_points(), !asked_for) << out;
    EXPECT_EQ(fit->report.tolerance_reached(), false);
    EXPECT_THAT(fit->report.warnings, testing::Contains(testing::HasSubstr("leaves"))) << out;
  }
  EXPECT_GT(fitted, 30);
  EXPECT_GT(told, 1);
}

}  // namespace batten::internal::surface_overshoot_test
