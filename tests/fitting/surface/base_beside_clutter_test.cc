// SPDX-License-Identifier: MIT
// Sheets with objects and stray points beside them, and sheets in two pieces.
#include "fitting/surface/base_beside_clutter.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "batten/fitting/distances.h"
#include "batten/fitting/fit_surface.h"
#include "batten/fitting/refused_data.h"
#include "random_splines.h"

namespace batten::internal::base_beside_clutter_test {

constexpr double kNoise = 1e-3;

// A cambered blade, twisted by up to 80 degrees along its length of 1.
Eigen::Vector3d Blade(double along, double across, double twist) {
  const double chord = 0.5 - 0.2 * along, angle = twist * (1 - along);
  const double x = across * chord, z = 0.08 * chord * (1 - 4 * across * across);
  return {
      along, x * std::cos(angle) - z * std::sin(angle), x * std::sin(angle) + z * std::cos(angle)};
}

struct Scene {
  PointCloud cloud;
  Eigen::Matrix3Xd truth;  // without noise
};

constexpr int kBlade = 9000, kBall = 700, kStray = 250;

// The blade's points first, then those of a ball beside it, then stray ones; turned.
Scene BladeBesideBall(unsigned seed) {
  RandomSplines random(seed);
  const double twist = random.Real(60, 80) * std::numbers::pi / 180;
  Eigen::Matrix3Xd points(3, kBlade + kBall + kStray), truth(3, kBlade);
  for (int k = 0; k < kBlade; ++k) {
    truth.col(k) = Blade(random.Real(0, 1), random.Real(-0.5, 0.5), twist);
    points.col(k) = truth.col(k) + random.Vector(kNoise);
  }
  const Eigen::Vector3d centre(random.Real(0.2, 0.8), 0.55, 0.1);
  for (int k = 0; k < kBall; ++k)
    points.col(kBlade + k) = centre + 0.15 * random.Vector(1).normalized();
  for (int k = 0; k < kStray; ++k)
    points.col(kBlade + kBall + k) = Eigen::Vector3d(0.5, 0.2, 0) + random.Vector(0.8);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(random.Real(0, 3), random.Vector(1).normalized()).toRotationMatrix();
  return {PointCloud::FromWorld(turn * points), turn * truth};
}

TEST(ChooseBesideClutterTest, ClutterDoesNotDecideTheBase) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Scene scene = BladeBesideBall(seed);
    const SurfaceFit fit = FitSurface(scene.cloud, {});
    EXPECT_LE(fit.outliers.head(kBlade).count(), kBlade / 100);
    EXPECT_GE(fit.outliers.tail(kBall + kStray).count(), (kBall + kStray) * 97 / 100);
    ThreadPool pool(2);
    const Eigen::VectorXd off =
        DistancesTo(fit.surface, scene.truth, fit.parameters.leftCols(kBlade), pool).distances;
    EXPECT_LE(std::sqrt(off.squaredNorm() / kBlade), 0.25 * kNoise);
    EXPECT_EQ(fit.report.termination, Termination::kNoiseReached);
  }
}

// A gentle sheet with a round outline, whose box has a fifth as many stray points, and two hollow
// balls beside it: over its plane they are heights that some surface would follow, and where it
// goes on into a corner of its domain it passes through one.
TEST(ChooseBesideClutterTest, AGentleSheetIsFoundAmongBallsAndOutliers) {
  constexpr int kSheet = 8000, kEach = 320, kOutliers = 1600;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const double bend = random.Real(0.2, 0.5), wave = random.Real(2, 5);
    const auto height = [&](double x, double y) {
      return bend * x * x - 0.2 * y * y + 0.03 * std::sin(wave * (x + y));
    };
    Eigen::Matrix3Xd points(3, kSheet + 2 * kEach + kOutliers), truth(3, kSheet);
    for (int k = 0; k < kSheet;) {
      const double x = random.Real(-0.5, 0.5), y = random.Real(-0.4, 0.4);
      if (std::hypot(x / 0.5, y / 0.4) > 1) continue;
      truth.col(k) << x, y, height(x, y);
      points.col(k) = truth.col(k) + random.Vector(kNoise);
      ++k;
    }
    for (int k = 0; k < 2 * kEach; ++k) {
      const Eigen::Vector3d centre = k < kEach ? Eigen::Vector3d(0.46, 0.36, height(0.46, 0.36))
                                               : Eigen::Vector3d(-0.45, -0.5, 0);
      points.col(kSheet + k) = centre + 0.08 * random.Vector(1).normalized();
    }
    for (int k = kSheet + 2 * kEach; k < points.cols(); ++k)
      points.col(k) << random.Real(-0.7, 0.7), random.Real(-0.6, 0.6), random.Real(-0.2, 0.3);
    const SurfaceFit fit = FitSurface(PointCloud::FromWorld(points), {});
    EXPECT_LE(fit.outliers.head(kSheet).count(), kSheet / 100);
    EXPECT_TRUE(fit.outliers.segment(kSheet, 2 * kEach).all());  // as wholes
    EXPECT_GE(fit.outliers.tail(points.cols() - kSheet).count(),
              (points.cols() - kSheet) * 97 / 100);
    ThreadPool pool(2);
    const Eigen::VectorXd off =
        DistancesTo(fit.surface, truth, fit.parameters.leftCols(kSheet), pool).distances;
    EXPECT_LE(std::sqrt(off.squaredNorm() / kSheet), 0.2 * kNoise);
    EXPECT_EQ(fit.report.termination, Termination::kNoiseReached);
  }
}

// A ball with five times the sheet's density, in a corner of the domain where the sheet goes on
// through it: its points near the surface vote for each other, and are off as a whole.
TEST(ChooseBesideClutterTest, ADenseBallIsNoIsland) {
  constexpr int kSheet = 8000, kBall = 700;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const double bend = random.Real(0.2, 0.5);
    const auto height = [&](double x, double y) { return bend * x * x - 0.2 * y * y; };
    Eigen::Matrix3Xd points(3, kSheet + kBall);
    for (int k = 0; k < kSheet;) {
      const double x = random.Real(-0.5, 0.5), y = random.Real(-0.4, 0.4);
      if (std::hypot(x / 0.5, y / 0.4) > 1) continue;
      points.col(k++) = Eigen::Vector3d(x, y, height(x, y)) + random.Vector(kNoise);
    }
    const Eigen::Vector3d centre(0.44, 0.34, height(0.44, 0.34));
    for (int k = kSheet; k < points.cols(); ++k)
      points.col(k) = centre + 0.03 * random.Vector(1).normalized();
    const SurfaceFit fit = FitSurface(PointCloud::FromWorld(points), {});
    EXPECT_LE(fit.outliers.head(kSheet).count(), kSheet / 100);
    EXPECT_TRUE(fit.outliers.tail(kBall).all());
    EXPECT_EQ(fit.report.termination, Termination::kNoiseReached);
  }
}

// Two discs of one wavy surface, so far apart in their radii.
PointCloud TwoDiscs(double apart, unsigned seed) {
  constexpr int kEach = 3000;
  RandomSplines random(seed);
  Eigen::Matrix3Xd points(3, 2 * kEach);
  for (int k = 0; k < 2 * kEach;) {
    const double u = random.Real(-1, 1), v = random.Real(-1, 1);
    if (std::hypot(u, v) > 1) continue;
    const double x = u + (k < kEach ? 0 : 2 + apart);
    points.col(k++) = Eigen::Vector3d(x, v, 0.2 * std::sin(x) * v) + random.Vector(kNoise);
  }
  return PointCloud::FromWorld(points);
}

TEST(ChooseBesideClutterTest, PiecesOfASurfaceGetARegionEachUnlessTheyAreFarApart) {
  const SurfaceFit fit = FitSurface(TwoDiscs(0.7, 1), {});
  EXPECT_EQ(fit.surface.trims().size(), 2U);
  EXPECT_EQ(fit.report.input.outliers, 0);
  EXPECT_EQ(fit.report.termination, Termination::kNoiseReached);
  EXPECT_THROW(FitSurface(TwoDiscs(30, 1), {}), RefusedData);
}

// Islands beside the mainland are heights as well.
TEST(ChooseBesideClutterTest, IslandsStay) {
  constexpr int kPoints = 6000;
  RandomSplines random(7);
  Eigen::Matrix3Xd points(3, kPoints);
  for (int k = 0; k < kPoints;) {
    const double x = random.Real(0, 1), y = random.Real(0, 1.4);
    const bool mainland = y < 1, island = std::hypot(x - 0.5, y - 1.25) < 0.1;
    if (!mainland && !island) continue;
    // Steps, so that no base fits within the noise.
    points.col(k++) = Eigen::Vector3d(x,
                                      y,
                                      0.5 * std::sin(4 * x) * std::cos(3 * y) +
                                          0.1 * std::round(std::sin(40 * x * y))) +
                      random.Vector(kNoise);
  }
  const SurfaceFit fit = FitSurface(PointCloud::FromWorld(points), {});
  EXPECT_LE(fit.report.input.outliers, kPoints / 50);
}

}  // namespace batten::internal::base_beside_clutter_test
