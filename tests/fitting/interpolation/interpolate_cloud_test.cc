// SPDX-License-Identifier: MIT
#include "batten/fitting/interpolate_cloud.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::interpolate_cloud_test {

using testing::ElementsAre;
using testing::HasSubstr;

Eigen::Matrix3Xd Ellipse(int count) {
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, count);
  for (int k = 0; k < count; ++k) {
    const double a = 2 * std::numbers::pi * k / count;
    points.col(k) << 3 * std::cos(a), std::sin(a), 0;
  }
  return points;
}

// The farthest of many places of the curve from the box of the points, over its diagonal.
double OutOfBox(const NurbsCurve<3>& curve, const Eigen::Matrix3Xd& points) {
  const Eigen::Vector3d low = points.rowwise().minCoeff(), high = points.rowwise().maxCoeff();
  double most = 0;
  for (int s = 0; s <= 20000; ++s) {
    const SplineBasis& basis = curve.basis();
    const Eigen::Vector3d place =
        curve.At(basis.lower() + (basis.upper() - basis.lower()) * s / 20000);
    most = std::max(most, (low - place).cwiseMax(place - high).cwiseMax(0).norm());
  }
  return most / (high - low).norm();
}

TEST(InterpolateCloudTest, WhatLeavesTheBoxOfItsPointsIsSaid) {
  int said = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    Eigen::Matrix3Xd points(3, random.Integer(6, 12));
    for (double& x : points.reshaped()) x = random.Real(-1, 1);
    Eigen::Matrix2Xd u = Eigen::Matrix2Xd::Zero(2, points.cols());
    for (Eigen::Index k = 1; k < points.cols(); ++k)  // some far closer to one another than others
      u(0, k) = u(0, k - 1) + std::pow(10, random.Real(-1.5, 0));
    PointCloud cloud = PointCloud::FromWorld(points);
    cloud.set_parameters(u);
    CloudInterpolationOptions options;
    options.degree = random.Integer(2, 5);
    options.parameterization = CurveParameterization::kGiven;
    options.tolerance = 1e-6;
    const CurveFit<3> fit = InterpolateCloud<3>(cloud, options);
    const double out = OutOfBox(fit.curve, points);
    if (std::abs(out - 0.5) < 0.02) continue;
    EXPECT_EQ(fit.report.leaves_points(), out > 0.5) << out;
    EXPECT_EQ(fit.report.tolerance_reached(), out <= 0.5);
    EXPECT_EQ(fit.report.warnings.size(), out > 0.5 ? 1 : 0);
    if (!fit.report.leaves_points()) continue;
    ++said;
    EXPECT_NEAR(*fit.report.overshoot->of_box, out, 0.05 * out);
    EXPECT_EQ(fit.report.end.code, EndCode::kStructuredResiduals);
    EXPECT_THAT(fit.report.warnings.back(), HasSubstr("leaves the box of its points"));
  }
  EXPECT_GT(said, 3);
}

TEST(InterpolateCloudTest, MeetsEveryPointFarFromZeroAndSaysSo) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    Eigen::Matrix3Xd points(3, random.Integer(6, 60));
    for (double& x : points.reshaped()) x = random.Real(-1, 1);
    points.colwise() += 5e6 * Eigen::Vector3d(1, 0.2, -0.4);
    points.col(3) = points.col(2);  // a repetition
    const PointCloud cloud = PointCloud::FromWorld(points);
    CloudInterpolationOptions options;
    options.degree = random.Integer(1, 5);
    options.closed = random.Coin();
    options.tolerance = 1e-6;
    options.shift = random.Coin() ? cloud.origin() : Eigen::Vector3d::Zero();
    const CurveFit<3> fit = InterpolateCloud<3>(cloud, options);
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      const double miss = (fit.curve.At(fit.parameters[k]) + options.shift - points.col(k)).norm();
      EXPECT_NEAR(miss, fit.residuals[k], 4e-9);
      // Rounding of coordinates at 5e6, where the curve stays there.
      EXPECT_LE(fit.residuals[k], 1e-8);
    }
    EXPECT_EQ(fit.parameters[2], fit.parameters[3]);
    EXPECT_EQ(fit.report.input.duplicates, 1);
    EXPECT_EQ(fit.report.input.points, points.cols());
    EXPECT_EQ(fit.report.termination,
              fit.report.leaves_points() ? Termination::kStalled : Termination::kToleranceReached);
    EXPECT_THAT(fit.report.geometry.closed, ElementsAre(options.closed));
    EXPECT_THAT(fit.report.geometry.control_points, ElementsAre(fit.curve.basis().size()));
    EXPECT_EQ(fit.curve.basis().size(), points.cols() - 1 + (options.closed ? options.degree : 0));
    EXPECT_FALSE(fit.outliers.any());
  }
}

TEST(InterpolateCloudTest, AClosedCurveMayRepeatItsFirstPointAtTheEnd) {
  const Eigen::Matrix3Xd once = Ellipse(24);
  Eigen::Matrix3Xd twice(3, 25);
  twice << once, once.col(0);
  CloudInterpolationOptions options;
  options.closed = true;
  const CurveFit<2> a = InterpolateCloud<2>(PointCloud(once, Eigen::Vector3d::Zero(), 2), options),
                    b = InterpolateCloud<2>(PointCloud(twice, Eigen::Vector3d::Zero(), 2), options);
  EXPECT_EQ(a.curve, b.curve);
  EXPECT_EQ(b.parameters[24], b.parameters[0]);
  EXPECT_TRUE(a.curve.basis().periodic());
  for (int k = 0; k <= 100; ++k) {
    const Eigen::Vector2d p = a.curve.At(k / 100.0);
    // The fourth power of steps of a quarter, by the derivatives of an ellipse of axes 3 and 1.
    EXPECT_NEAR(Eigen::Vector2d(p.x() / 3, p.y()).norm(), 1, 3e-3);
  }
}

TEST(InterpolateCloudTest, GivenParametersAreTheCurvesOwnAndMayComeInAnyOrder) {
  const Eigen::Matrix3Xd points = Ellipse(20);
  Eigen::Matrix2Xd u = Eigen::Matrix2Xd::Zero(2, 20);
  std::vector<Eigen::Index> mixed;
  for (int k = 0; k < 20; ++k) {
    u(0, k) = 10 + 0.3 * k + 0.01 * k * k;
    mixed.push_back(7 * k % 20);
  }
  PointCloud cloud(points);
  cloud.set_parameters(u);
  CloudInterpolationOptions options;
  options.parameterization = CurveParameterization::kGiven;
  const CurveFit<3> sorted = InterpolateCloud<3>(cloud, options);
  EXPECT_EQ(sorted.parameters, u.row(0).transpose());
  EXPECT_EQ(sorted.curve.basis().lower(), 10);
  EXPECT_EQ(sorted.curve.basis().upper(), u(0, 19));
  EXPECT_EQ(InterpolateCloud<3>(cloud.Picked(mixed), options).curve, sorted.curve);
  options.closed = true;
  const CurveFit<3> closed = InterpolateCloud<3>(cloud, options);
  EXPECT_EQ(closed.parameters, sorted.parameters);
  EXPECT_GT(closed.curve.basis().upper(), u(0, 19));
  EXPECT_LE(closed.residuals.maxCoeff(), kRounding * 10);
}

TEST(InterpolateCloudTest, TangentsPointWhereTheyAreToldAndDegreeAndParametersAreTheUsers) {
  const PointCloud cloud(Ellipse(15));
  for (const CurveParameterization kind : {CurveParameterization::kUniform,
                                           CurveParameterization::kChord,
                                           CurveParameterization::kCentripetal,
                                           CurveParameterization::kFoley,
                                           CurveParameterization::kUniversal}) {
    SCOPED_TRACE(Name(kind));
    CloudInterpolationOptions options;
    options.parameterization = kind;
    options.degree = 4;
    options.start_tangent = Eigen::Vector3d(1, 2, 3);
    options.end_tangent = Eigen::Vector3d(0, 0, -1);
    const CurveFit<3> fit = InterpolateCloud<3>(cloud, options);
    EXPECT_LE(fit.residuals.maxCoeff(), 100 * kRounding);
    const Eigen::Vector3d start = fit.curve.JetAt(0).first.normalized(),
                          end = fit.curve.JetAt(1).first.normalized();
    EXPECT_LE((start - options.start_tangent->normalized()).norm(), kIterated);
    EXPECT_LE((end - *options.end_tangent).norm(), kIterated);
    EXPECT_EQ(fit.report.geometry.base, Name(kind));
    EXPECT_EQ(fit.report.termination, Termination::kNoiseReached);
  }
}

TEST(InterpolateCloudTest, SaysWhatOfACurvatureInSpaceCannotBeMet) {
  const PointCloud cloud(Ellipse(9));
  const auto fitted = [&](const Eigen::Vector3d& curvature) {
    CloudInterpolationOptions options;
    options.spline = SplineEnds::kCurvature;
    options.start_tangent = Eigen::Vector3d(0, 1, 0);
    options.end_curvature = curvature;
    return InterpolateCloud<3>(cloud, options);
  };
  const CurveFit<3> first = fitted({0, 0, 0});
  const Eigen::Vector3d tangent = first.curve.JetAt(first.curve.basis().upper()).first.normalized();
  const CurveFit<3> along = fitted(2 * tangent);
  ASSERT_EQ(along.report.warnings.size(), first.report.warnings.size() + 1);
  EXPECT_THAT(along.report.warnings.back(), HasSubstr("of the curvature given at the end"));
}

TEST(InterpolateCloudTest, SaysWhatItCannotDo) {
  const auto error = [](const PointCloud& cloud, const CloudInterpolationOptions& options) {
    try {
      InterpolateCloud<3>(cloud, options);
    } catch (const std::invalid_argument& e) {
      return std::string(e.what());
    }
    return std::string("none");
  };
  const PointCloud cloud(Ellipse(5));
  EXPECT_THAT(error(PointCloud(Ellipse(3)), {}), HasSubstr("lower the degree to 2"));
  EXPECT_THAT(error(PointCloud(Eigen::Matrix3Xd::Ones(3, 6)), {}),
              HasSubstr("at least 2 different"));
  EXPECT_THAT(error(PointCloud(), {}), HasSubstr("no points"));
  EXPECT_THAT(error(cloud, {.closed = true, .start_tangent = Eigen::Vector3d(1, 0, 0)}),
              HasSubstr("no ends"));
  EXPECT_THAT(error(cloud, {.degree = 1, .end_tangent = Eigen::Vector3d(1, 0, 0)}),
              HasSubstr("takes no start or end tangent"));
  EXPECT_THAT(error(cloud, {.end_tangent = Eigen::Vector3d(0, 0, 0)}), HasSubstr("no direction"));
  EXPECT_THAT(error(cloud, {.tolerance = 0}), HasSubstr("not positive"));
  EXPECT_THAT(error(PointCloud(Ellipse(2)), {.degree = 1, .closed = true}),
              HasSubstr("at least 3"));
  PointCloud same = cloud;
  same.set_parameters(Eigen::Matrix2Xd{{0, 1, 1, 2, 3}, {0, 0, 0, 0, 0}});
  EXPECT_THAT(error(same, {.parameterization = CurveParameterization::kGiven}),
              HasSubstr("two different points have the parameter u = 1"));
}

// Neighbours a rounding error apart next to steps of one.
TEST(InterpolateCloudTest, RefusesACurveThatRoundingKeepsOffThePoints) {
  Eigen::Matrix3Xd points(3, 10);
  for (int k = 0; k < 10; ++k) points.col(k) << std::pow(10, -2 * k), std::pow(10, -k), 0;
  try {
    InterpolateCloud<3>(PointCloud(points),
                        {.degree = 8, .parameterization = CurveParameterization::kFoley});
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("lower the degree 8"));
  }
  const CurveFit<3> cubic = InterpolateCloud<3>(PointCloud(points));
  EXPECT_LE(cubic.residuals.maxCoeff(), 1e-6);
}

// The domain of an even degree begins between two points: those before it come at the other end.
TEST(InterpolateCloudTest, ParametersOfAClosedCurveAreInItsDomain) {
  for (unsigned seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    RandomSplines random(seed);
    const int count = random.Integer(4, 9);
    Eigen::Matrix2Xd parameters = Eigen::Matrix2Xd::Zero(2, count);
    for (int k = 0; k < count; ++k)
      parameters(0, k) = (k > 0 ? parameters(0, k - 1) : 0) + random.Real(0.5, 1);
    PointCloud cloud(Ellipse(count));
    cloud.set_parameters(parameters);
    const CurveFit<3> fit = InterpolateCloud<3>(
        cloud, {.degree = 2, .parameterization = CurveParameterization::kGiven, .closed = true});
    EXPECT_GE(fit.parameters.minCoeff(), fit.curve.basis().lower());
    EXPECT_LE(fit.parameters.maxCoeff(), fit.curve.basis().upper());
  }
}

}  // namespace batten::internal::interpolate_cloud_test
