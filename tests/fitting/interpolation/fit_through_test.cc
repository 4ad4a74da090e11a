// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_through.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "batten/fitting/fit_curve.h"
#include "batten/geometry/foot_point.h"
#include "random_splines.h"
#include "refusal.h"
#include "tolerances.h"

namespace batten::internal::fit_through_test {

// Noisy points along y = sin x, or round an ellipse.
PointCloud Wave(int count, double noise, unsigned seed, const Eigen::Vector3d& at = {0, 0, 0}) {
  RandomSplines random(seed);
  Eigen::Matrix3Xd points(3, count);
  for (int k = 0; k < count; ++k) {
    const double x = 6.0 * k / (count - 1);
    points.col(k) << x, std::sin(x) + noise * random.Real(-1, 1), 0;
  }
  return PointCloud::FromWorld(points.colwise() + at, 2);
}

double DistanceFrom(const NurbsCurve<2>& curve, const Eigen::Vector3d& point) {
  return CurveFootPoints<2>(curve).Nearest({point.x(), point.y(), 0}).distance;
}

TEST(FitThroughTest, PlacesAreMetExactlyAndAlongTheirDirections) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const PointCloud cloud = Wave(200, 0.02, seed);
    const std::vector<MetPlace> places = {{{0, 0, 0}, Eigen::Vector3d(1, 1, 0)},
                                          {{1.5, 1.02, 0}},
                                          {{4.6, -1, 0}, Eigen::Vector3d(-2, 0.1, 0)}};
    const CurveFit<2> fit = FitCurveThrough<2>(cloud, places);
    for (const MetPlace& place : places) {
      EXPECT_LE(DistanceFrom(fit.curve, place.point), kIterated);
      if (!place.direction) continue;
      const double u = CurveFootPoints<2>(fit.curve).Nearest(place.point).u;
      const Eigen::Vector2d along = fit.curve.JetAt(u).first.normalized(),
                            wanted = place.direction->head<2>().normalized();
      EXPECT_LE(std::abs(along.x() * wanted.y() - along.y() * wanted.x()), kIterated);
    }
    EXPECT_LE(fit.report.error.rms, 0.05);
  }
}

// At given parameters a place is met at its own, and points stay at theirs.
TEST(FitThroughTest, GivenParametersArePlacesOwn) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    PointCloud cloud = Wave(120, 0.05, seed);
    Eigen::Matrix2Xd parameters = Eigen::Matrix2Xd::Zero(2, cloud.size());
    for (Eigen::Index k = 0; k < cloud.size(); ++k)
      parameters(0, k) = (static_cast<double>(k) + random.Real(-0.4, 0.4)) / 119;
    cloud.set_parameters(parameters);
    CurveFitOptions options;
    options.parameterization = CurveParameterization::kGiven;
    const CurveFit<2> fit = FitCurveThrough<2>(
        cloud, {{cloud.World(0)}, {cloud.World(40)}, {{4.7, -1.1, 0}, {}, 0.77}}, options);
    for (const Eigen::Index k : {0, 40}) {
      EXPECT_LE((fit.curve.At(parameters(0, k)) - cloud.World(k).head<2>()).norm(), kIterated);
    }
    EXPECT_LE((fit.curve.At(0.77) - Eigen::Vector2d(4.7, -1.1)).norm(), kIterated);
    ASSERT_TRUE(fit.report.parameter_error);
    double sum = 0;
    for (Eigen::Index k = 0; k < cloud.size(); ++k)
      sum += (fit.curve.At(parameters(0, k)) - cloud.World(k).head<2>()).squaredNorm();
    EXPECT_NEAR(fit.report.parameter_error->rms, std::sqrt(sum / 120), kIterated);
  }
}

// A place at the first or last point is where the curve begins or ends.
TEST(FitThroughTest, PlacesAtTheEndsAreTheEnds) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const PointCloud cloud = Wave(80, 0.05, seed);
    const CurveFit<2> fit = FitCurveThrough<2>(
        cloud,
        {{cloud.World(0), Eigen::Vector3d(1, 1, 0)}, {cloud.World(79), Eigen::Vector3d(1, 1, 0)}});
    const SplineBasis& basis = fit.curve.basis();
    EXPECT_LE((fit.curve.At(basis.lower()) - cloud.World(0).head<2>()).norm(), kIterated);
    EXPECT_LE((fit.curve.At(basis.upper()) - cloud.World(79).head<2>()).norm(), kIterated);
  }
}

// The report is of the curve that is returned.
TEST(FitThroughTest, ResidualsAreThoseOfTheCurveReturned) {
  const PointCloud cloud = Wave(150, 0.01, 3);
  CurveFitOptions options;
  options.shift = {1, 2, 0};
  const CurveFit<2> fit = FitCurveThrough<2>(cloud, {{{3, 0.14, 0}}}, options);
  for (Eigen::Index k = 0; k < cloud.size(); ++k)
    EXPECT_NEAR(
        fit.residuals[k], DistanceFrom(fit.curve, cloud.World(k) - options.shift), kIterated);
}

TEST(FitThroughTest, HeavyPointsAreMetMoreNearly) {
  PointCloud cloud = Wave(60, 0.2, 5);
  CurveFitOptions options;
  options.control_points = 6;
  options.loss = Loss::kNone;
  const std::vector<MetPlace> start = {{cloud.World(0)}};
  const double before = std::abs(FitCurveThrough<2>(cloud, start, options).residuals[30]);
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(cloud.size());
  weights[30] = 1e6;
  cloud.set_weights(weights);
  const double after = std::abs(FitCurveThrough<2>(cloud, start, options).residuals[30]);
  EXPECT_LT(after, before / 10);
}

TEST(FitThroughTest, ATouchedToleranceIsKeptWithMoreKnots) {
  const PointCloud cloud = Wave(400, 0, 1);
  CurveFitOptions options;
  options.tolerance = 1e-4;
  const CurveFit<2> fit =
      FitCurveThrough<2>(cloud, {{{0, 0, 0}, Eigen::Vector3d(1, 1, 0)}}, options);
  EXPECT_LE(fit.report.error.max, 1e-4);
  EXPECT_EQ(fit.report.termination, Termination::kToleranceReached);
  EXPECT_LE(DistanceFrom(fit.curve, {0, 0, 0}), kIterated);
}

TEST(FitThroughTest, ManyPlacesInOneSpanGetKnotsOfTheirOwn) {
  const PointCloud cloud = Wave(300, 0.01, 2);
  CurveFitOptions options;
  options.control_points = 5;
  std::vector<MetPlace> places;
  for (int k = 0; k < 9; ++k) {
    const double x = 2 + 0.15 * k;
    places.push_back({{x, std::sin(x), 0}});
  }
  const CurveFit<2> fit = FitCurveThrough<2>(cloud, places, options);
  for (const MetPlace& place : places) EXPECT_LE(DistanceFrom(fit.curve, place.point), kIterated);
}

TEST(FitThroughTest, ClosedCurvesAndFarCoordinatesMeetTheirPlaces) {
  Eigen::Matrix3Xd points(3, 240);
  RandomSplines random(4);
  for (int k = 0; k < 240; ++k) {
    const double a = 2 * std::numbers::pi * k / 240;
    points.col(k) << 3 * std::cos(a), std::sin(a), 0.5 * std::sin(2 * a);
    points.col(k) += 0.003 * random.Vector(1);
  }
  const Eigen::Vector3d far(5e6, 4e5, 100), place = far + Eigen::Vector3d(3.01, 0, 0);
  const CurveFit<3> fit = FitCurveThrough<3>(PointCloud::FromWorld(points.colwise() + far),
                                             {{place, Eigen::Vector3d(0, 1, 1)}});
  EXPECT_TRUE(fit.report.geometry.closed.front());
  EXPECT_LE(CurveFootPoints<3>(fit.curve).Nearest(place).distance, 64 * 0x1p-52 * 5e6);
}

TEST(FitThroughTest, RefusesWhatCannotBeMet) {
  const PointCloud cloud = Wave(100, 0.01, 6);
  const auto refusal = [&](const std::vector<MetPlace>& places) {
    return RefusalOf([&] { FitCurveThrough<2>(cloud, places); });
  };
  EXPECT_THAT(refusal({{{NAN, 0, 0}}}), testing::HasSubstr("place 1 to be met is not finite"));
  EXPECT_THAT(refusal({{{1, 0, 0}, Eigen::Vector3d(0, 0, 0)}}),
              testing::HasSubstr("place 1 to be met has no direction"));
  EXPECT_THAT(refusal({{{-1, 0, 0}}, {{-2, 0, 0}}}),
              testing::HasSubstr("follows from the other exact conditions or contradicts them"));
}

}  // namespace batten::internal::fit_through_test
