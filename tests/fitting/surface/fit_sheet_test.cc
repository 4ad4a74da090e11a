// SPDX-License-Identifier: MIT
// Whole fits of bent sheets: what holds whatever the base.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "batten/fitting/distances.h"
#include "batten/fitting/fit_surface.h"
#include "bent_sheets.h"

namespace batten::internal::fit_sheet_test {

constexpr double kSigma = 1e-3;

// An arc of 220 degrees whose radius waves along its axis.
BentSheet WavyArc() {
  return {"wavy arc", [](double u, double v) {
            const double angle = 220 * std::numbers::pi / 180 * (u - 0.5);
            const double radius = 1 + 0.1 * std::sin(9 * v) * std::cos(3 * angle);
            return Eigen::Vector3d(radius * std::sin(angle), 2 * v, -radius * std::cos(angle));
          }};
}

bool InHole(double u, double v) { return std::hypot(3.84 * (u - 0.5), 2 * (v - 0.5)) < 0.4; }

PointCloud CloudOn(const BentSheet& sheet, Eigen::Index count, std::uint64_t seed = 1) {
  return PointCloud::FromWorld(
      PointsOn(sheet, {.count = count, .sigma = kSigma, .seed = seed}).points);
}

bool Warns(const FitReport& report, const std::string& words) {
  return std::any_of(report.warnings.begin(), report.warnings.end(), [&](const std::string& w) {
    return w.find(words) != std::string::npos;
  });
}

double FarthestInHole(const NurbsSurface& surface, const BentSheet& sheet) {
  std::vector<Eigen::Vector3d> inside;
  for (int i = 0; i <= 60; ++i) {
    for (int j = 0; j <= 60; ++j) {
      if (InHole(i / 60.0, j / 60.0)) inside.push_back(sheet.at(i / 60.0, j / 60.0));
    }
  }
  const Eigen::Map<const Eigen::Matrix3Xd> truth(inside.data()->data(), 3, std::ssize(inside));
  ThreadPool pool(2);
  return DistancesTo(surface, truth, pool).distances.cwiseAbs().maxCoeff();
}

TEST(FitSheetTest, IsLaidOutWithItsLengths) {
  const SurfaceFit fit = FitSurface(CloudOn(ArcSheet(220), 6000));
  EXPECT_EQ(fit.report.geometry.base, "sheet");
  EXPECT_FALSE(fit.report.geometry.base_why.empty());
  EXPECT_LE(fit.report.geometry.distortion, 5e-3);
  EXPECT_LE(fit.report.error.rms, 1.05 * kSigma);
  EXPECT_EQ(fit.report.input.outliers, 0);
}

TEST(FitSheetTest, IsTheSameForEveryNumberOfThreads) {
  const PointCloud cloud = CloudOn(WavyArc(), 4000);
  SurfaceFitOptions options;
  options.threads = 1;
  const SurfaceFit one = FitSurface(cloud, options);
  options.threads = 3;
  const SurfaceFit three = FitSurface(cloud, options);
  EXPECT_EQ(one.surface.control_points(), three.surface.control_points());
  EXPECT_TRUE((one.outliers == three.outliers).all());
}

TEST(FitSheetTest, KeepsEveryPointWhenToldTo) {
  Eigen::Matrix3Xd points = PointsOn(ArcSheet(220), {.count = 5000, .sigma = kSigma}).points;
  points.col(100) *= 0.5;  // far off the sheet, where no base has a place for them
  points.col(2000) *= 0.4;
  SurfaceFitOptions options;
  const SurfaceFit without = FitSurface(PointCloud::FromWorld(points), options);
  EXPECT_EQ(without.report.input.outliers, 2);
  options.keep_outliers = true;
  const SurfaceFit with = FitSurface(PointCloud::FromWorld(points), options);
  EXPECT_EQ(with.report.geometry.base, "sheet");
  EXPECT_EQ(with.report.input.outliers, 0);
  EXPECT_EQ(with.report.error.points, 5000);
}

// A void keeps calm and is told of whether there is a tolerance or not.
TEST(FitSheetTest, VoidsAreCalmWithAToleranceToo) {
  BentSheet holed = WavyArc();
  holed.inside = [](double u, double v) { return !InHole(u, v); };
  const PointCloud cloud = CloudOn(holed, 12000);
  SurfaceFitOptions options;
  options.optimize = FreeVariables{false, false, false};
  options.trim = Trimming::kNone;
  const SurfaceFit plain = FitSurface(cloud, options);
  options.tolerance = 2.5 * kSigma;
  const SurfaceFit refined = FitSurface(cloud, options);
  EXPECT_TRUE(Warns(plain.report, "there are no points in"));
  EXPECT_TRUE(Warns(refined.report, "there are no points in"));
  // The radius waves by 0.1: a calm surface is off by about that in the hole.
  EXPECT_LE(FarthestInHole(plain.surface, WavyArc()), 0.15);
  EXPECT_LE(FarthestInHole(refined.surface, WavyArc()), 0.15);
}

// Whatever is asked for beyond what the points carry is done, and said.
TEST(FitSheetTest, WarnsWhereTheNoiseWouldBeFollowed) {
  for (const BentSheet& sheet : {ArcSheet(220), FlatSheet()}) {
    SCOPED_TRACE(sheet.name);
    const PointCloud cloud = CloudOn(sheet, 4000);
    const SurfaceFit plain = FitSurface(cloud);
    EXPECT_FALSE(Warns(plain.report, "follow the noise"));
    SurfaceFitOptions options;
    options.tolerance = kSigma / 2;
    EXPECT_TRUE(Warns(FitSurface(cloud, options).report, "the tolerance is below the noise"));
    options.tolerance = 6 * kSigma;
    EXPECT_FALSE(Warns(FitSurface(cloud, options).report, "the tolerance is below the noise"));
    options.tolerance.reset();
    options.control_points = {50, 50};
    EXPECT_TRUE(Warns(FitSurface(cloud, options).report, "follow the noise"));
    options.control_points = {12, 6};
    EXPECT_FALSE(Warns(FitSurface(cloud, options).report, "follow the noise"));
  }
}

TEST(FitSheetTest, ExactPlanesNeedNoJointStage) {
  Eigen::Matrix3Xd points(3, 900);
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const double x = static_cast<double>(k / 30) / 29, y = static_cast<double>(k % 30) / 29;
    points.col(k) << x, y, 0.3 * x - 2 * y;
  }
  const SurfaceFit fit = FitSurface(PointCloud::FromWorld(points));
  EXPECT_FALSE(fit.report.optimize.ran);
  EXPECT_EQ(fit.report.termination, Termination::kNoiseReached);
}

}  // namespace batten::internal::fit_sheet_test
