// SPDX-License-Identifier: MIT
#include "fitting/surface/surface_overshoot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "batten/fitting/distances.h"
#include "batten/fitting/fit_report.h"
#include "batten/fitting/fit_surface.h"
#include "batten/geometry/surface_evaluator.h"
#include "tolerances.h"

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

// Twenty places of a tube, from which a sheet goes off at a corner.
Eigen::Matrix3Xd FewPoints() {
  Eigen::Matrix<double, 20, 3> rows;
  rows << 0.77, 1.85, 4.35, 0.21, 1.99, 0.97, 1.15, 1.64, 4.36, 0.99, -1.74, 1.49, 1.77, -0.93,
      2.05, -0.9, 1.79, 3.6, -1.36, -1.47, 5.61, 0.49, -1.94, 2.11, -2.0, 0.1, 0.05, 1.92, -0.55,
      5.69, -1.99, -0.16, 4.25, -1.49, 1.33, 0.16, -1.02, -1.72, 5.37, -1.85, -0.76, 2.71, -0.55,
      1.92, 0.16, 1.93, -0.53, 4.82, 1.89, 0.66, 2.02, -1.77, 0.93, 1.76, -0.45, 1.95, 5.54, -1.71,
      -1.04, 3.96;
  return rows.transpose();
}

TEST(FitSurfaceOvershootTest, SurfacesThatLeaveTheBoxOfTheirPointsAreTold) {
  const Eigen::Matrix3Xd points = FewPoints();
  const Eigen::AlignedBox3d box(points.rowwise().minCoeff(), points.rowwise().maxCoeff());
  const Eigen::Vector3d far(1000, 2000, 0);
  for (const Trimming trim : {Trimming::kAuto, Trimming::kNone}) {
    SurfaceFitOptions options;
    options.tolerance = 1e-9;
    options.trim = trim;
    options.threads = 1;
    const SurfaceFit fit = FitSurface(PointCloud::FromWorld(points.colwise() + far), options);
    ASSERT_FALSE(fit.surface.trimmed());
    const double out = OutOfBox(fit.surface, box.translated(far));
    ASSERT_GT(out, 0.5);
    const bool asked_for = trim == Trimming::kNone;
    EXPECT_EQ(fit.report.leaves_points(), !asked_for);
    EXPECT_THAT(fit.report.warnings,
                testing::Contains(testing::HasSubstr("leaves the box of its points")));
    EXPECT_NEAR(fit.report.overshoot->of_box.value(), out, 0.01 * out);
    const Eigen::Vector3d at = fit.report.overshoot->at - far;
    EXPECT_NEAR(std::sqrt(box.squaredExteriorDistance(at)),
                fit.report.overshoot->max,
                kIterated * fit.report.overshoot->max);
  }
}

// A wavy sheet whose density falls a hundredfold from one side to the other: where its points are
// sparse they are ten times as far apart as where they are dense, and nothing is missing. A quarter
// of it was held to be without points, was flattened between them and trimmed.
TEST(MeasureOvershootTest, SparsePointsAreNoGap) {
  constexpr int kPoints = 40000;
  constexpr double kNoise = 1e-3;
  const auto height = [](double x, double y) { return 0.06 * std::sin(9 * x) * std::cos(6 * y); };
  for (unsigned seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 engine(seed);
    std::uniform_real_distribution<double> uniform;
    std::normal_distribution<double> noise(0, kNoise);
    Eigen::Matrix3Xd points(3, kPoints);
    for (Eigen::Index k = 0; k < kPoints; ++k) {
      // The density goes as 100^-x.
      const double x = -std::log(1 - 0.99 * uniform(engine)) / std::log(100.0), y = uniform(engine);
      points.col(k) << x, y, height(x, y) + noise(engine);
    }
    const SurfaceFit fit = FitSurface(PointCloud::FromWorld(points), {});
    EXPECT_LT(fit.report.overshoot->share_without_points, 0.01);
    EXPECT_FALSE(fit.surface.trimmed());
    Eigen::Matrix3Xd truth(3, 99 * 99);
    for (int i = 0; i < 99; ++i)
      for (int j = 0; j < 99; ++j) {
        const double x = (i + 1) / 100.0, y = (j + 1) / 100.0;
        truth.col(i * 99 + j) << x, y, height(x, y);
      }
    ThreadPool pool(2);
    const Eigen::VectorXd off = DistancesTo(fit.surface, truth, pool).distances;
    EXPECT_LT(std::sqrt(off.squaredNorm() / static_cast<double>(off.size())), 0.2 * kNoise);
    EXPECT_LT(off.cwiseAbs().maxCoeff(), 3 * kNoise);
  }
}

}  // namespace batten::internal::surface_overshoot_test
