// SPDX-License-Identifier: MIT
// Surfaces at given parameters.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <string>

#include "batten/fitting/fit_surface.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::given_parameters_test {

using ::testing::HasSubstr;

constexpr double kSigma = 1e-3;

SurfaceFitOptions Given() {
  SurfaceFitOptions options;
  options.given_parameters = true;
  options.optimize = FreeVariables{};
  options.threads = 2;
  return options;
}

PointCloud CloudOf(const Eigen::Matrix3Xd& points, const Eigen::Matrix2Xd& parameters) {
  PointCloud cloud = PointCloud::FromWorld(points);
  cloud.set_parameters(parameters);
  return cloud;
}

// Nearly all of a cylinder of radius 1 and height 4, parameters (angle, height): no height field.
PointCloud Cylinder(int count, unsigned seed, double unit_u = 1, double unit_v = 1) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> noise(0, kSigma);
  Eigen::Matrix3Xd points(3, count);
  Eigen::Matrix2Xd parameters(2, count);
  for (int k = 0; k < count; ++k) {
    const double a = 6 * uniform(engine), h = 4 * uniform(engine), r = 1 + noise(engine);
    points.col(k) << r * std::cos(a), r * std::sin(a), h;
    parameters.col(k) << unit_u * a, unit_v * h;
  }
  return CloudOf(points, parameters);
}

// How far the surface is from the cylinder, rms over a grid of parameters.
double OffTheCylinder(const NurbsSurface& surface) {
  constexpr int kSamples = 60;
  double squares = 0;
  const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
  for (int i = 0; i <= kSamples; ++i) {
    for (int j = 0; j <= kSamples; ++j) {
      const Eigen::Vector3d p = surface.At(u.lower() + (u.upper() - u.lower()) * i / kSamples,
                                           v.lower() + (v.upper() - v.lower()) * j / kSamples);
      squares += std::pow(p.head<2>().norm() - 1, 2);
    }
  }
  return std::sqrt(squares) / (kSamples + 1);
}

TEST(FitSurfaceAtParametersTest, RecoversASplineFromItsPoints) {
  RandomSplines random(1);
  for (int trial = 0; trial < 20; ++trial) {
    SCOPED_TRACE("seed 1, trial " + std::to_string(trial));
    const int p = random.Integer(1, 4), q = random.Integer(1, 4);
    const int n = p + random.Integer(1, 4), m = q + random.Integer(1, 4);
    const double u0 = random.Real(-9, 9), v0 = random.Real(-9, 9);
    const SplineBasis bu = SplineBasis::Uniform(p, n, u0, u0 + random.Logarithmic(1e-2, 1e2)),
                      bv = SplineBasis::Uniform(q, m, v0, v0 + random.Logarithmic(1e-2, 1e2));
    Eigen::Matrix3Xd net(3, n * m);
    for (double& value : net.reshaped()) value = random.Real(-1, 1);
    const NurbsSurface truth(bu, bv, net);
    const int count = 40 * n * m;
    Eigen::Matrix2Xd parameters(2, count);
    Eigen::Matrix3Xd points(3, count);
    for (int k = 0; k < count; ++k) {
      parameters.col(k) << (k < 2 ? (k == 0 ? bu.lower() : bu.upper())
                                  : random.Real(bu.lower(), bu.upper())),
          (k < 2 ? (k == 0 ? bv.lower() : bv.upper()) : random.Real(bv.lower(), bv.upper()));
      points.col(k) = truth.At(parameters(0, k), parameters(1, k));
    }
    SurfaceFitOptions options = Given();
    options.degree_u = p;
    options.degree_v = q;
    options.control_points = {n, m};
    options.smoothing = 0;
    options.keep_outliers = true;
    const SurfaceFit fit = FitSurface(CloudOf(points, parameters), options);
    EXPECT_EQ(fit.surface.basis_u().lower(), bu.lower());
    EXPECT_EQ(fit.surface.basis_u().upper(), bu.upper());
    EXPECT_EQ(fit.surface.basis_v().upper(), bv.upper());
    EXPECT_LT(fit.report.parameter_error->max, kIterated);
    // Normal equations square the condition.
    EXPECT_LT((fit.surface.control_points() - net).cwiseAbs().maxCoeff(), kHalfDigits);
  }
}

TEST(FitSurfaceAtParametersTest, FollowsWhatIsNoHeightFieldWhateverTheUnitsAre) {
  for (const auto& [unit_u, unit_v] :
       {std::pair{1.0, 1.0}, {57.3, 1000.0}, {1e-6, 1e6}, {1e9, 1e-9}}) {
    SCOPED_TRACE(std::to_string(unit_u) + " " + std::to_string(unit_v));
    const PointCloud cloud = Cylinder(4000, 2, unit_u, unit_v);
    const SurfaceFit fit = FitSurface(cloud, Given());
    EXPECT_EQ(fit.surface.basis_u().lower(), cloud.parameters().row(0).minCoeff());
    EXPECT_EQ(fit.surface.basis_u().upper(), cloud.parameters().row(0).maxCoeff());
    const double n = fit.surface.size_u() * fit.surface.size_v();
    EXPECT_LT(OffTheCylinder(fit.surface), 2 * kSigma * std::sqrt(n / 4000));
    EXPECT_EQ(fit.report.termination, Termination::kNoiseReached);
    EXPECT_EQ(fit.report.geometry.base, "given");
    EXPECT_LT(fit.surface.size_v(), fit.surface.size_u());
    EXPECT_NEAR(fit.report.parameter_error->rms, kSigma, 0.1 * kSigma);
  }
}

TEST(FitSurfaceAtParametersTest, SetsOutliersAside) {
  const PointCloud clean = Cylinder(3000, 3);
  Eigen::Matrix3Xd points = clean.points();
  for (Eigen::Index k = 0; k < 3000; k += 60) points.col(k).head<2>() *= 1.4;
  const SurfaceFit fit = FitSurface(CloudOf(points, clean.parameters()), Given());
  EXPECT_GE(fit.report.input.outliers, 50);
  EXPECT_LE(fit.report.input.outliers, 60);
  for (Eigen::Index k = 0; k < 3000; k += 60) EXPECT_TRUE(fit.outliers[k]);
  EXPECT_LT(OffTheCylinder(fit.surface), 1.5 * OffTheCylinder(FitSurface(clean, Given()).surface));
}

TEST(FitSurfaceAtParametersTest, KeepsATolerance) {
  SurfaceFitOptions options = Given();
  for (const double tolerance : {0.1, 0.01}) {
    options.tolerance = tolerance;
    const SurfaceFit fit = FitSurface(Cylinder(3000, 4), options);
    EXPECT_TRUE(fit.report.tolerance_reached().value());
    EXPECT_LE(fit.report.error.max, tolerance);
  }
  options.tolerance = kSigma / 4;
  const SurfaceFit fit = FitSurface(Cylinder(3000, 4), options);
  EXPECT_FALSE(fit.report.tolerance_reached().value());
  EXPECT_GT(fit.report.error.out_of_tolerance, 0);
}

// The seam of a closed sheet: places that agree while their parameters are far apart.
TEST(FitSurfaceAtParametersTest, DoesNotMergePointsWhoseParametersDiffer) {
  const int rows = 20, columns = 40;
  Eigen::Matrix3Xd points(3, rows * columns);
  Eigen::Matrix2Xd parameters(2, rows * columns);
  for (int k = 0; k < rows * columns; ++k) {
    const int i = k % columns, j = k / columns;
    const double a = 2 * M_PI * (i % (columns - 1)) / (columns - 1);
    points.col(k) << std::cos(a), std::sin(a), 0.1 * j;
    parameters.col(k) << i, j;
  }
  SurfaceFitOptions options = Given();
  options.control_points = {16, 4};
  options.smoothing = 1e-9;
  const SurfaceFit fit = FitSurface(CloudOf(points, parameters), options);
  EXPECT_EQ(fit.report.input.duplicates, 0);
  EXPECT_LT(fit.report.parameter_error->max, 1e-2);
  // The same rows twice are one point each, and change nothing.
  Eigen::Matrix3Xd points_twice(3, 2 * points.cols());
  Eigen::Matrix2Xd parameters_twice(2, 2 * points.cols());
  points_twice << points, points;
  parameters_twice << parameters, parameters;
  const SurfaceFit twice = FitSurface(CloudOf(points_twice, parameters_twice), options);
  EXPECT_TRUE(twice.surface.control_points().isApprox(fit.surface.control_points(), kIterated));
}

TEST(FitSurfaceAtParametersTest, MovesWithFarCoordinates) {
  const PointCloud cloud = Cylinder(2000, 5);
  SurfaceFitOptions options = Given();
  const SurfaceFit fit = FitSurface(cloud, options);
  const Eigen::Vector3d far(0x1p19, 0x1p22, 256);
  PointCloud moved(cloud.points(), far);
  moved.set_parameters(cloud.parameters());
  options.shift = far;
  const SurfaceFit there = FitSurface(moved, options);
  EXPECT_TRUE(there.surface.control_points().isApprox(fit.surface.control_points(), kIterated));
  EXPECT_NEAR(there.report.parameter_error->rms, fit.report.parameter_error->rms, kIterated);
}

TEST(FitSurfaceAtParametersTest, GivesTheSameBitsForEveryNumberOfThreads) {
  SurfaceFitOptions options = Given();
  options.threads = 1;
  const SurfaceFit one = FitSurface(Cylinder(3000, 6), options);
  options.threads = 3;
  const SurfaceFit three = FitSurface(Cylinder(3000, 6), options);
  EXPECT_EQ(one.surface, three.surface);
  EXPECT_EQ(one.residuals, three.residuals);
}

TEST(FitSurfaceAtParametersTest, RefusesWhatCarriesNoSurface) {
  const PointCloud cloud = Cylinder(200, 7);
  const auto refusal = [&](const Eigen::Matrix3Xd& points,
                           const Eigen::Matrix2Xd& parameters) -> std::string {
    try {
      FitSurface(CloudOf(points, parameters), Given());
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "not refused";
  };
  const Eigen::Matrix3Xd& p = cloud.points();
  const Eigen::Matrix2Xd& uv = cloud.parameters();
  Eigen::Matrix2Xd one_u = uv, one_v = uv, large = uv;
  one_u.row(0).setConstant(3);
  one_v.row(1).setZero();
  large.array() += 1e14;
  EXPECT_THAT(refusal(p, Eigen::Matrix2Xd(2, 0)), HasSubstr("no parameters"));
  EXPECT_THAT(refusal(p, one_u), HasSubstr("parameters u are all equal"));
  EXPECT_THAT(refusal(p, one_v), HasSubstr("parameters v are all equal"));
  EXPECT_THAT(refusal(p, large), HasSubstr("hardly differ"));
  EXPECT_THAT(refusal(p.leftCols(3), uv.leftCols(3)), HasSubstr("at least 4"));
  EXPECT_THAT(refusal(Eigen::Vector3d(1, 2, 3) * uv.row(0), uv), HasSubstr("on a line"));
  EXPECT_THAT(refusal(1e-200 * p, uv), HasSubstr("less than 1e-100"));
}

}  // namespace batten::internal::given_parameters_test
