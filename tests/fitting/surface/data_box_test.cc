// SPDX-License-Identifier: MIT
// Few and badly placed points: no surface goes far beyond them, whatever was asked for.
#include "fitting/surface/data_box.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <string>

#include "batten/fitting/fit_surface.h"
#include "random_splines.h"

namespace batten::internal::data_box_test {

constexpr int kClouds = 60;
// Of the diagonal of the points' box: corners of a rectangle that is turned in it reach half as
// far.
constexpr double kLaw = 0.6;

// On a piece of a random shape, in stripes, in clumps or anywhere.
PointCloud FewPoints(unsigned seed, RandomSplines& random) {
  const int count = random.Integer(6, 120);
  const double noise = std::pow(10.0, random.Integer(-6, -1));
  Eigen::Matrix3Xd points(3, count);
  for (int k = 0; k < count; ++k) {
    double u = random.Real(0, 1), v = random.Real(0, 1);
    if (seed % 4 == 1) u = std::round(5 * u) / 5;
    if (seed % 4 == 2) v = u + 0.1 * v;
    const double height = seed % 3 == 0   ? double(u > 0.5)
                          : seed % 3 == 1 ? std::max(u, v)
                                          : 0.3 * std::sin(7 * u) * std::cos(5 * v);
    points.col(k) = Eigen::Vector3d(u, v, height) + random.Vector(noise);
    if (seed % 4 == 3) points.col(k) = random.Vector(1);
  }
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(random.Real(0, 3), random.Vector(1).normalized()).toRotationMatrix();
  return PointCloud::FromWorld(turn * points);
}

SurfaceFitOptions OptionsOf(unsigned seed, RandomSplines& random) {
  SurfaceFitOptions options;
  options.trim = Trimming::kNone;
  options.threads = 1;
  options.base = seed % 2 ? BaseShape::kPlane : BaseShape::kAuto;
  options.degree_u = options.degree_v = seed % 5 == 0 ? random.Integer(4, 9) : 3;
  if (random.Integer(0, 3) == 0) options.smoothing = 0;
  if (random.Integer(0, 3) == 0) options.tolerance = std::pow(10.0, random.Integer(-5, 0));
  if (random.Integer(0, 4) == 0) options.optimize = FreeVariables{true, true, false};
  return options;
}

// No place is farther outside of the box than the law allows.
void ExpectWithin(const Eigen::AlignedBox3d& box, const NurbsSurface& surface) {
  const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
  double beyond = 0;
  constexpr int kAcross = 60;
  for (int i = 0; i <= kAcross; ++i) {
    for (int j = 0; j <= kAcross; ++j) {
      const Eigen::Vector3d place =
          surface.At(u.Clamp(u.lower() + (u.upper() - u.lower()) * i / kAcross),
                     v.Clamp(v.lower() + (v.upper() - v.lower()) * j / kAcross));
      beyond = std::max(beyond, (box.min() - place).cwiseMax(place - box.max()).maxCoeff());
    }
  }
  EXPECT_LE(beyond, kLaw * box.diagonal().norm());
}

TEST(DataBoxTest, UntrimmedSurfacesStayNearTheBoxOfFewPoints) {
  int fitted = 0;
  for (unsigned seed = 0; seed < kClouds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const PointCloud cloud = FewPoints(seed, random);
    const SurfaceFitOptions options = OptionsOf(seed, random);
    try {
      const SurfaceFit fit = FitSurface(cloud, options);
      ++fitted;
      Eigen::AlignedBox3d box;
      for (Eigen::Index k = 0; k < cloud.size(); ++k)
        if (!fit.outliers[k]) box.extend(cloud.World(k));
      ExpectWithin(box, fit.surface);
    } catch (const std::invalid_argument&) {  // refused
    }
  }
  EXPECT_GT(fitted, kClouds / 3);
}

// Few noisy points of a ball with creases, whose free parameters would let corners fly off.
PointCloud NoisyCap(RandomSplines& random) {
  constexpr int kPoints = 260;
  constexpr double kNoise = 0.035;
  Eigen::Matrix3Xd points(3, kPoints);
  for (int k = 0; k < kPoints;) {
    const Eigen::Vector3d at = random.Vector(1);
    const Eigen::Vector3d on = at.normalized();
    if (at.norm() > 1 || on[2] < 0.3 + 0.25 * std::sin(3 * std::atan2(on[1], on[0]))) continue;
    const double radius = 1 + 0.12 * std::sin(4 * on[0] + 1) * std::cos(5 * on[1]) +
                          0.25 * std::abs(std::sin(3 * on[0])) - 0.2 * std::abs(on[1]);
    points.col(k++) =
        (radius * on).cwiseProduct(Eigen::Vector3d(1, 0.8, 0.7)) + random.Vector(kNoise);
  }
  return PointCloud::FromWorld(points);
}

TEST(DataBoxTest, JointStageHoldsWhatFewPointsDoNotDetermine) {
  constexpr int kCaps = 8, kTakenAtLeast = 6;
  int taken = 0;
  for (unsigned seed = 0; seed < kCaps; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const PointCloud cloud = NoisyCap(random);
    SurfaceFitOptions options;
    options.base = BaseShape::kSheet;
    options.control_points = {9, 9};
    options.optimize = FreeVariables{true, false, false};
    const SurfaceFit fit = FitSurface(cloud, options);
    EXPECT_LE(BeyondBox(fit.surface, cloud.points()), 0.5);
    taken += fit.report.optimize.rms_after < 0.97 * fit.report.optimize.rms_before;
  }
  EXPECT_GE(taken, kTakenAtLeast);
}

// A handful of points, with nothing given: too few to trim to.
TEST(DataBoxTest, SurfacesOfAHandfulOfPointsStayNearThem) {
  constexpr int kHandfuls = 120;
  int fitted = 0;
  for (unsigned seed = 0; seed < kHandfuls; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    Eigen::Matrix3Xd points(3, random.Integer(4, 8));
    const double flat = std::pow(10.0, -random.Integer(0, 3));
    for (auto point : points.colwise())
      point = random.Vector(1).cwiseProduct(Eigen::Vector3d(1, random.Real(0.3, 1), flat));
    SurfaceFitOptions options;
    options.threads = 1;
    if (seed % 3 == 0) options.degree_u = options.degree_v = random.Integer(1, 5);
    if (seed % 4 == 0) options.tolerance = std::pow(10.0, random.Integer(-6, -1));
    try {
      const SurfaceFit fit = FitSurface(PointCloud::FromWorld(points), options);
      ++fitted;
      if (fit.surface.trimmed()) continue;
      const Eigen::AlignedBox3d box(points.rowwise().minCoeff(), points.rowwise().maxCoeff());
      ExpectWithin(box, fit.surface);
    } catch (const std::invalid_argument&) {  // refused
    }
  }
  EXPECT_GT(fitted, kHandfuls / 3);
}

TEST(DataBoxTest, FarMoreControlPointsThanPointsAreRefused) {
  RandomSplines random(1);
  const PointCloud cloud = FewPoints(0, random);
  SurfaceFitOptions options;
  options.control_points = {200, 200};
  EXPECT_THROW(FitSurface(cloud, options), std::invalid_argument);
}

// Supports that hold no data look for them farther away: of 69 points and 10,000 control points
// that took as long as 40,000 squared.
TEST(DataBoxTest, ManyControlPointsOnFewPointsTakeSeconds) {
  RandomSplines random(5);
  Eigen::Matrix3Xd points(3, 30);
  for (auto point : points.colwise()) point = random.Vector(1);
  points.row(2) *= 0.1;
  SurfaceFitOptions options;
  options.control_points = {100, 100};
  options.base = BaseShape::kPlane;
  options.tolerance = 1e-6;
  const auto begin = std::chrono::steady_clock::now();
  const SurfaceFit fit = FitSurface(PointCloud::FromWorld(points), options);
  EXPECT_EQ(fit.surface.size_u(), 100);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
}

}  // namespace batten::internal::data_box_test
