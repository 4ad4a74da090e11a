// SPDX-License-Identifier: MIT
// Whether errors of fitted surfaces are what their standard deviations say.
#include "fitting/primitives/shape_estimate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <variant>
#include <vector>

#include "measured_shapes.h"
#include "tolerances.h"

namespace batten::internal::shape_estimate_test {

using ::testing::HasSubstr;

struct Estimated {
  ShapeFit fit;
  ShapeEstimate estimate;
  Eigen::Vector3d centroid;  // of the points, in their coordinates
};

Estimated Estimate(const Eigen::Matrix3Xd& points, SurfaceKind kind, double rounding = 1e-15) {
  ThreadPool pool(2);
  ShapeFitter fitter(points, {}, {}, pool);
  Estimated result;
  result.fit = fitter.Fit(kind);
  result.estimate = EstimateOf(result.fit, fitter, rounding, pool);
  result.centroid = fitter.middle() + fitter.unit() * fitter.starts().centroid;
  return result;
}

// What the numbers of the fit are off by, in their order.
Eigen::VectorXd Errors(const Estimated& found, const MeasuredShape& truth) {
  const ShapeEstimate& e = found.estimate;
  Eigen::VectorXd errors(e.values.size());
  Eigen::Vector3d axis = truth.turn.col(2);
  const auto tilt = [&](const Eigen::Vector3d& fitted) {
    if (axis.dot(fitted) < 0) axis = -axis;
    return Eigen::Vector2d(axis.dot(e.frame_x), axis.dot(e.frame_y));
  };
  const SurfaceShape& shape = found.fit.shape;
  if (const auto* plane = std::get_if<PlaneShape>(&shape)) {
    errors.tail<2>() = tilt(plane->normal);
    errors[0] = (truth.shift - found.centroid).dot(axis) -
                (plane->point - found.centroid).dot(plane->normal);
  } else if (const auto* sphere = std::get_if<SphereShape>(&shape)) {
    errors << sphere->center - truth.shift, sphere->radius - truth.radius;
  } else if (const auto* cylinder = std::get_if<CylinderShape>(&shape)) {
    const Eigen::Vector2d tilted = tilt(cylinder->axis);
    const auto beside = [&](const Eigen::Vector3d& point, const Eigen::Vector3d& along) {
      return (point + (found.centroid - point).dot(along) * along).eval();
    };
    const Eigen::Vector3d off = beside(cylinder->point, cylinder->axis) - beside(truth.shift, axis);
    errors << tilted, off.dot(e.frame_x), off.dot(e.frame_y), cylinder->radius - truth.radius;
  } else if (const auto* cone = std::get_if<ConeShape>(&shape)) {
    errors << tilt(cone->axis), cone->apex - truth.shift, cone->half_angle - truth.half_angle;
  } else {
    const TorusShape& torus = std::get<TorusShape>(shape);
    errors << tilt(torus.axis), torus.center - truth.shift, torus.major_radius - truth.major_radius,
        torus.minor_radius - truth.radius;
  }
  return errors;
}

// How many errors, of each number, are beyond three of their standard deviations, and the mean
// square of all in units of these.
struct Calibration {
  Eigen::VectorXi outside;
  double squares = 0;
};

Calibration Calibrated(SurfaceKind kind, int draws, int points, double part, unsigned seed) {
  RandomSplines random(seed);
  Calibration result{Eigen::VectorXi::Zero(FreedomsOf(kind))};
  for (int draw = 0; draw < draws; ++draw) {
    const MeasuredShape truth = RandomShape(kind, random);
    const double sigma = random.Logarithmic(1e-5, 2e-3);
    const Estimated found =
        Estimate(RandomPoints(truth, PieceOf(truth, part, random), points, random, sigma), kind);
    const Eigen::VectorXd off =
        Errors(found, truth).cwiseAbs().cwiseQuotient(found.estimate.standard_deviations);
    result.outside += (off.array() > 3).cast<int>().matrix();
    result.squares += off.cwiseMin(5).squaredNorm() / static_cast<double>(off.size() * draws);
  }
  return result;
}

// Normal errors are beyond three standard deviations in 0.27 % of cases, and their squares have the
// mean one. That of slivers, whose errors are all one, spreads by √(2 / draws) about it.
void ExpectCalibrated(SurfaceKind kind, int draws, int points, double part, unsigned seed) {
  SCOPED_TRACE(std::string(Name(kind)) + ", part " + std::to_string(part) + ", seed " +
               std::to_string(seed));
  const Calibration found = Calibrated(kind, draws, points, part, seed);
  const double spread = std::sqrt(2.0 / draws);
  EXPECT_LE(found.outside.maxCoeff(), std::max(2.0, 0.01 * draws));
  EXPECT_LE(found.squares, 1.1 + 3 * spread);
  EXPECT_GE(found.squares, part < 0.5 ? 0.6 - 2 * spread : 0.85 - 3 * spread);
}

class ShapeEstimateTest : public ::testing::TestWithParam<SurfaceKind> {};
class LongShapeEstimateTest : public ::testing::TestWithParam<SurfaceKind> {};

TEST_P(ShapeEstimateTest, ErrorsAreWithinThreeStandardDeviations) {
  ExpectCalibrated(GetParam(), 100, 150, 1, 1);
}

TEST_P(LongShapeEstimateTest, ErrorsAreWithinThreeStandardDeviationsInNinetyNinePercent) {
  ExpectCalibrated(GetParam(), 500, 250, 1, 11);
  ExpectCalibrated(GetParam(), 500, 250, 0.25, 12);
  ExpectCalibrated(GetParam(), 500, 400, 0.12, 13);
}

const auto kNameOfKind = [](const auto& info) { return std::string(Name(info.param)); };
INSTANTIATE_TEST_SUITE_P(Kinds, ShapeEstimateTest, ::testing::ValuesIn(kSurfaceKinds), kNameOfKind);
INSTANTIATE_TEST_SUITE_P(LongKinds,
                         LongShapeEstimateTest,
                         ::testing::ValuesIn(kSurfaceKinds),
                         kNameOfKind);

TEST(ShapeNumbersTest, ExactPointsGiveExactNumbers) {
  RandomSplines random(3);
  for (int trial = 0; trial < 30; ++trial) {
    SCOPED_TRACE(trial);
    const SurfaceKind kind = kSurfaceKinds[trial % 5];
    const bool far = trial % 2 == 1;
    const MeasuredShape truth = RandomShape(kind, random, far ? 1e6 : 1);
    const Eigen::Matrix3Xd points =
        RandomPoints(truth, PieceOf(truth, random.Coin() ? 1 : 0.5, random), 2000, random);
    const Estimated found = Estimate(points, kind, far ? 1e-9 : 1e-15);
    EXPECT_LE(Errors(found, truth).lpNorm<Eigen::Infinity>(), far ? kIterated : kRounding);
    EXPECT_TRUE(found.estimate.warnings.empty());
  }
}

TEST(ShapeNumbersTest, SaysWhatThePointsDoNotDetermine) {
  RandomSplines random(4);
  const auto warnings = [&](SurfaceKind kind, const ShapePiece& piece, double sigma) {
    MeasuredShape truth;
    truth.kind = kind;
    truth.Place();
    const Estimated found = Estimate(RandomPoints(truth, piece, 400, random, sigma), kind);
    std::string all;
    for (const std::string& warning : found.estimate.warnings) all += warning + "; ";
    return all;
  };
  constexpr double kDegrees = std::numbers::pi / 180;
  EXPECT_THAT(warnings(SurfaceKind::kCylinder, {0, 5 * kDegrees, 0, 0.5}, 3e-3),
              HasSubstr("do not determine the radius"));
  EXPECT_THAT(warnings(SurfaceKind::kSphere, {0, 5 * kDegrees, 0, 5 * kDegrees}, 3e-3),
              HasSubstr("do not determine the radius"));
  EXPECT_THAT(warnings(SurfaceKind::kCone, {0, 8 * kDegrees, 1, 0.2}, 2e-3),
              HasSubstr("do not determine the half angle"));
  EXPECT_THAT(warnings(SurfaceKind::kTorus, {0, 4 * kDegrees, 0, 60 * kDegrees}, 5e-3),
              HasSubstr("do not determine the major radius"));
  EXPECT_EQ(warnings(SurfaceKind::kCylinder, {0, 90 * kDegrees, 0, 0.5}, 1e-3), "");
}

// Errors that neighbours share: of two pieces that share none, the radii differ by what is said.
TEST(ShapeNumbersTest, KnowsErrorsThatNeighboursShare) {
  RandomSplines random(5);
  int outside = 0;
  constexpr int kTrials = 20;
  for (int trial = 0; trial < kTrials; ++trial) {
    MeasuredShape truth;
    truth.kind = SurfaceKind::kCylinder;
    truth.radius = 0.5;
    truth.Place();
    const double phase = random.Real(0, 6), wave = random.Real(12, 25);
    const auto radius = [&](bool upper) {
      Eigen::Matrix3Xd points(3, 3000);
      for (auto p : points.colwise()) {
        const double u = random.Real(0, 3), v = random.Real(0, 1) + (upper ? 1 : 0);
        const double bump = 2e-3 * std::sin(wave * u + phase + 5 * v) * std::cos(wave * 2 * v + u);
        p = truth.At(u, v) + (bump + random.Real(-1e-4, 1e-4)) * truth.NormalAt(u, v);
      }
      const Estimated found = Estimate(points, SurfaceKind::kCylinder);
      EXPECT_GT(found.estimate.inflation, 1);
      return Eigen::Vector2d(found.estimate.values[4], found.estimate.Deviation("radius"));
    };
    const Eigen::Vector2d low = radius(false), high = radius(true);
    if (std::abs(low[0] - high[0]) > 3 * std::hypot(low[1], high[1])) ++outside;
  }
  EXPECT_LE(outside, kTrials / 20);
}

}  // namespace batten::internal::shape_estimate_test
