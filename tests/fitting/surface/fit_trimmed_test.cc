// SPDX-License-Identifier: MIT
// Surfaces cut back to the outline and the holes of their points, and those that need no cut.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "batten/fitting/fit_surface.h"
#include "batten/geometry/foot_point.h"
#include "batten/geometry/surface_area.h"
#include "batten/geometry/trim_region.h"
#include "jittered_shell.h"

namespace batten::internal::fit_trimmed_test {

using Inside = std::function<bool(double, double)>;

double Hill(double x, double y) { return 0.2 * std::sin(3 * x) * std::cos(2 * y); }

Eigen::Matrix3d Turn(unsigned seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal(0, 1);
  return Eigen::Quaterniond(normal(engine), normal(engine), normal(engine), normal(engine))
      .normalized()
      .toRotationMatrix();
}

// Points of the hill over a part of the unit square, with noise, turned.
PointCloud Hilly(Eigen::Index count, const Inside& inside, const Eigen::Matrix3d& turn) {
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal(0, 1e-3);
  Eigen::Matrix3Xd points(3, count);
  for (Eigen::Index k = 0; k < count;) {
    const double x = uniform(engine), y = uniform(engine);
    if (!inside(x, y)) continue;
    points.col(k++) = turn * Eigen::Vector3d(x, y, Hill(x, y) + normal(engine));
  }
  return PointCloud(std::move(points));
}

bool Everywhere(double, double) { return true; }
bool InL(double x, double y) { return x < 0.45 || y < 0.55; }
bool InRing(double x, double y) {
  const double r = std::hypot(x - 0.5, y - 0.5);
  return r < 0.48 && r > 0.2;
}

// The area of the hill over a part, by the middle rule: right to the cells its border passes.
double AreaOver(const Inside& inside) {
  constexpr int kCells = 1500;
  double sum = 0;
  for (int i = 0; i < kCells; ++i) {
    for (int j = 0; j < kCells; ++j) {
      const double x = (i + 0.5) / kCells, y = (j + 0.5) / kCells;
      if (!inside(x, y)) continue;
      sum += std::sqrt(1 + std::pow(0.6 * std::cos(3 * x) * std::cos(2 * y), 2) +
                       std::pow(0.4 * std::sin(3 * x) * std::sin(2 * y), 2));
    }
  }
  return sum / (kCells * kCells);
}

TEST(FitTrimmedTest, CutsTheSurfaceBackToItsPoints) {
  struct Case {
    const char* name;
    Inside inside;
    size_t loops;
  };
  for (const Case& one : {Case{"L", InL, 1}, {"ring", InRing, 2}}) {
    SCOPED_TRACE(one.name);
    const Eigen::Matrix3d turn = Turn(3);
    const PointCloud cloud = Hilly(50000, one.inside, turn);
    const SurfaceFit fit = FitSurface(cloud);
    ASSERT_EQ(fit.surface.trims().size(), one.loops);
    EXPECT_EQ(fit.report.geometry.trims, static_cast<int>(one.loops));
    CheckTrims(fit.surface);
    const double area = AreaOver(one.inside);
    EXPECT_NEAR(Area(fit.surface), area, 0.006 * area);
    const TrimRegion region(fit.surface);
    const SurfaceFootPoints feet(fit.surface);
    int wrong = 0, tried = 0;
    // Places of the surface are inside where they are over the part, but for its border.
    const SplineBasis &u = fit.surface.basis_u(), &v = fit.surface.basis_v();
    constexpr double kBorder = 0.02;  // three spacings
    for (int i = 0; i <= 100; ++i) {
      for (int j = 0; j <= 100; ++j) {
        const double at_u = u.lower() + (u.upper() - u.lower()) * i / 100,
                     at_v = v.lower() + (v.upper() - v.lower()) * j / 100;
        const Eigen::Vector3d p = turn.transpose() * fit.surface.At(at_u, at_v);
        if (std::abs(p[2] - Hill(p[0], p[1])) > kBorder) continue;  // a guess beyond the points
        int around = 0;
        for (const double dx : {-kBorder, kBorder}) {
          for (const double dy : {-kBorder, kBorder}) {
            const double x = p[0] + dx, y = p[1] + dy;
            around += x > 0 && x < 1 && y > 0 && y < 1 && one.inside(x, y) ? 1 : 0;
          }
        }
        if (around % 4 != 0) continue;
        ++tried;
        if (region.Contains(at_u, at_v) == (around == 4)) continue;
        // Beyond the points the surface is a guess, which may run under the part that counts.
        const SurfaceFoot foot = feet.Nearest(fit.surface.At(at_u, at_v));
        const bool elsewhere = std::hypot(foot.u - at_u, foot.v - at_v) > kBorder;
        wrong += around == 4 && elsewhere && foot.distance < kBorder ? 0 : 1;
      }
    }
    EXPECT_GT(tried, 5000);
    EXPECT_EQ(wrong, 0);
  }
}

TEST(FitTrimmedTest, MeasuresDistancesFromThePartThatIsLeft) {
  const PointCloud cloud = Hilly(8000, InRing, Eigen::Matrix3d::Identity());
  const SurfaceFit fit = FitSurface(cloud);
  ASSERT_EQ(fit.surface.trims().size(), 2u);
  const TrimRegion region(fit.surface);
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    EXPECT_TRUE(region.Contains(fit.parameters(0, k), fit.parameters(1, k)));
    const Eigen::Vector3d foot = fit.surface.At(fit.parameters(0, k), fit.parameters(1, k));
    EXPECT_NEAR((cloud.World(k) - foot).norm(), std::abs(fit.residuals[k]), 1e-9);
  }
  // The points lie on it: what sticks out does so by a part of the spacing.
  EXPECT_LT(fit.report.error.max, 0.008);
}

TEST(FitTrimmedTest, LeavesARectangleWhole) {
  for (const unsigned turn : {0U, 1U, 2U}) {
    SCOPED_TRACE(turn);
    const SurfaceFit fit =
        FitSurface(Hilly(20000, Everywhere, turn == 0 ? Eigen::Matrix3d::Identity() : Turn(turn)));
    EXPECT_FALSE(fit.surface.trimmed());
  }
  std::mt19937_64 engine(4);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal(0, 1e-3);
  Eigen::Matrix3Xd points(3, 20000);
  for (auto point : points.colwise()) {
    point = Shell(uniform(engine), uniform(engine));
    for (double& x : point) x += normal(engine);
  }
  const SurfaceFit shell = FitSurface(PointCloud(points));
  EXPECT_FALSE(shell.surface.trimmed()) << "its wavy ends become edges";
  EXPECT_LT(shell.report.error.rms, 1.05e-3);
}

TEST(FitTrimmedTest, KeepsTheRectangleWhereThatIsAskedFor) {
  SurfaceFitOptions options;
  options.trim = Trimming::kNone;
  const SurfaceFit fit = FitSurface(Hilly(5000, InRing, Eigen::Matrix3d::Identity()), options);
  EXPECT_FALSE(fit.surface.trimmed());
  bool said = false;
  for (const std::string& warning : fit.report.warnings)
    said = said || warning.find("no points in") != std::string::npos;
  EXPECT_TRUE(said);
}

TEST(FitTrimmedTest, EveryPartIsARegion) {
  const auto beside = [](double x, double) { return x < 0.46 || x > 0.54; };
  const SurfaceFit fit = FitSurface(Hilly(8000, beside, Eigen::Matrix3d::Identity()));
  CheckTrims(fit.surface);
  EXPECT_EQ(LoopsByRegion(fit.surface).size(), 2u);
  const TrimRegion region(fit.surface);
  const SplineBasis &u = fit.surface.basis_u(), &v = fit.surface.basis_v();
  EXPECT_FALSE(region.Contains((u.lower() + u.upper()) / 2, (v.lower() + v.upper()) / 2));
  bool said = false;
  for (const std::string& warning : fit.report.warnings)
    said = said || warning.find("fall into 2 parts") != std::string::npos;
  EXPECT_TRUE(said);
  EXPECT_LT(fit.report.error.rms, 1.1e-3);
}

TEST(FitTrimmedTest, TrimsOverGivenParametersInTheirUnits) {
  const PointCloud plain = Hilly(8000, InRing, Eigen::Matrix3d::Identity());
  PointCloud cloud = plain;
  Eigen::Matrix2Xd parameters = plain.points().topRows<2>();
  parameters.row(0) = 100 + 7 * parameters.row(0).array();
  cloud.set_parameters(parameters);
  SurfaceFitOptions options;
  options.given_parameters = true;
  const SurfaceFit fit = FitSurface(cloud, options);
  ASSERT_EQ(fit.surface.trims().size(), 2u);
  CheckTrims(fit.surface);
  const TrimRegion region(fit.surface);
  EXPECT_TRUE(region.Contains(100 + 7 * 0.85, 0.5));
  EXPECT_FALSE(region.Contains(100 + 7 * 0.5, 0.5));
}

}  // namespace batten::internal::fit_trimmed_test
