// SPDX-License-Identifier: MIT
// Curves of every kind from nothing but their points: closed, unordered, sharp, in parts, conic,
// and among outliers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "batten/fitting/fit_curve.h"
#include "batten/geometry/classify_shape.h"
#include "dense_samples.h"
#include "geometry/numeric/constants.h"
#include "ordered_curves.h"
#include "tolerances.h"

namespace batten::internal::fit_curve_shapes_test {

using ::testing::HasSubstr;

Eigen::Matrix3Xd Noisy(Eigen::Matrix3Xd points, double sigma, unsigned seed, int dimension) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> noise;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    for (int i = 0; i < dimension; ++i) points(i, k) += sigma * noise(engine);
  }
  return points;
}

PointCloud Plane(Eigen::Matrix3Xd points) {
  return PointCloud(std::move(points), Eigen::Vector3d::Zero(), 2);
}

PointCloud Shuffled(const PointCloud& cloud, unsigned seed) {
  std::vector<Eigen::Index> order(static_cast<size_t>(cloud.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::shuffle(order.begin(), order.end(), std::mt19937(seed));
  return cloud.Picked(order);
}

// Replaces a share of the points by others anywhere in the box.
Eigen::Matrix3Xd WithOutliers(Eigen::Matrix3Xd points, double share, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  const Eigen::Vector3d low = points.rowwise().minCoeff(), high = points.rowwise().maxCoeff();
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    if (unit(engine) >= share) continue;
    for (int i = 0; i < 3; ++i) points(i, k) = low[i] + (high[i] - low[i]) * unit(engine);
  }
  return points;
}

// The rms distance of the curve from a dense row of the shape.
template <int Dim>
double TruthRms(const NurbsCurve<Dim>& curve, const Eigen::Matrix3Xd& shape, bool closed) {
  double squares = 0;
  const std::vector<double> at = DenseParameters(curve.basis(), 300);
  for (const double u : at) {
    Eigen::Vector3d q = Eigen::Vector3d::Zero();
    q.head<Dim>() = curve.At(u);
    Eigen::Index k = 0;
    (shape.colwise() - q).colwise().squaredNorm().minCoeff(&k);
    double best = (shape.col(k) - q).norm();
    for (const Eigen::Index j : {k - 1, k + 1}) {
      if (!closed && (j < 0 || j >= shape.cols())) continue;
      const Eigen::Vector3d a = shape.col(k), b = shape.col((j + shape.cols()) % shape.cols()) - a;
      const double t = std::clamp(b.dot(q - a) / b.squaredNorm(), 0.0, 1.0);
      best = std::min(best, (q - a - t * b).norm());
    }
    squares += best * best;
  }
  return std::sqrt(squares / static_cast<double>(at.size()));
}

TEST(FitCurveShapesTest, ClosesSmoothlyWherePointsClose) {
  for (const bool shuffled : {false, true}) {
    for (const double sigma : {0.0, 0.01}) {
      SCOPED_TRACE(std::to_string(shuffled) + " " + std::to_string(sigma));
      PointCloud cloud = Plane(Noisy(Flower(1500), sigma, 3, 2));
      if (shuffled) cloud = Shuffled(cloud, 5);
      const CurveFit<2> fit = FitCurve<2>(cloud);
      ASSERT_EQ(fit.report.geometry.closed, std::vector<bool>{true});
      EXPECT_TRUE(fit.curve.basis().periodic());
      const SplineBasis& basis = fit.curve.basis();
      const Eigen::MatrixXd before = fit.curve.Derivatives(std::nextafter(basis.upper(), 0), 2),
                            behind = fit.curve.Derivatives(basis.lower(), 2);
      for (int order = 0; order <= 2; ++order) {
        EXPECT_LT((before.col(order) - behind.col(order)).norm(),
                  kIterated * (1 + behind.col(order).norm()));
      }
      const double n = fit.report.geometry.control_points[0];
      EXPECT_LT(TruthRms(fit.curve, Flower(20000), true), 1.6 * sigma * std::sqrt(n / 1500) + 1e-4);
    }
  }
}

TEST(FitCurveShapesTest, ClosedCurvesOpenAndOpenOnesCloseWhenTold) {
  CurveFitOptions options;
  options.closed = ClosedChoice::kNo;
  EXPECT_FALSE(FitCurve<2>(Plane(Flower(400)), options).report.geometry.closed[0]);
  options.closed = ClosedChoice::kYes;
  const CurveFit<2> arc = FitCurve<2>(Plane(Arc(300, 240)), options);
  EXPECT_TRUE(arc.report.geometry.closed[0]);
  EXPECT_THAT(arc.report.warnings, ::testing::Contains(HasSubstr("apart")));
}

TEST(FitCurveShapesTest, TheOrderOfThePointsIsFoundAgain) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const PointCloud cloud(Noisy(Helix(3000), 2e-3, seed, 3));
    const CurveFit<3> ordered = FitCurve<3>(cloud), shuffled = FitCurve<3>(Shuffled(cloud, seed));
    EXPECT_FALSE(shuffled.report.geometry.closed[0]);
    EXPECT_EQ(shuffled.report.input.outliers, 0);
    EXPECT_LT(TruthRms(shuffled.curve, Helix(40000), false),
              1.5 * TruthRms(ordered.curve, Helix(40000), false));
  }
}

// The corners of a square and the straight sides between them, all there is to it.
TEST(FitCurveShapesTest, KeepsCorners) {
  for (const double sigma : {0.0, 2e-4}) {
    SCOPED_TRACE(sigma);
    Eigen::Matrix3Xd points(3, 400);
    const Eigen::Matrix<double, 3, 4> corners{{0, 1, 1, 0}, {0, 0, 1, 1}, {0, 0, 0, 0}};
    for (int k = 0; k < 400; ++k) {
      const int side = k / 100;
      points.col(k) = corners.col(side) +
                      (corners.col((side + 1) % 4) - corners.col(side)) * ((k % 100) / 100.0);
    }
    const CurveFit<2> fit = FitCurve<2>(Plane(Noisy(points, sigma, 1, 2)));
    EXPECT_TRUE(fit.report.geometry.closed[0]);
    // Twelve, where noise leaves no knot that looks as if it were worth its place.
    EXPECT_LE(fit.report.geometry.control_points[0], sigma > 0 ? 20 : 12);
    const CurveFootPoints<2> feet(fit.curve);
    for (int c = 0; c < 4; ++c) {
      EXPECT_LT(feet.Nearest(corners.col(c)).distance, 3 * sigma + kIterated);
    }
    CurveFitOptions smooth;
    smooth.corners = false;
    const SplineBasis basis = FitCurve<2>(Plane(points), smooth).curve.basis();
    for (const double knot : basis.knots()) EXPECT_EQ(basis.Multiplicity(knot), 1);
  }
}

// Arcs that meet at corners, of many points with noise: a smooth curve that turns within the noise
// needs more control points and is farther off.
TEST(FitCurveShapesTest, KeepsCornersOfManyPointsWithNoise) {
  constexpr double kSigma = 0.01;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 engine(seed);
    const double phase = std::uniform_real_distribution<double>(0, std::numbers::pi)(engine);
    const auto arcs = [&](double x) {
      return Eigen::Vector3d(x, std::abs(std::sin(x * std::numbers::pi / 2 + phase)), 0);
    };
    const CurveFit<2> fit =
        FitCurve<2>(Plane(Noisy(AlongCurve(3000, 0, 4, arcs), kSigma, seed, 2)));
    EXPECT_LE(fit.report.geometry.control_points[0], 32);
    EXPECT_LT(TruthRms(fit.curve, AlongCurve(40000, 0, 4, arcs), false), 0.14 * kSigma);
  }
}

TEST(FitCurveShapesTest, ListsSeparateCurves) {
  Eigen::Matrix3Xd points(3, 900);
  points << Ellipse(600, 3, 2), Ellipse(300, 1, 0.5).colwise() + Eigen::Vector3d(8, 1, 0);
  const PointCloud cloud = Shuffled(Plane(points), 7);
  try {
    FitCurve<2>(cloud);
    FAIL() << "two curves are not one";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("2 separate curves"));
    EXPECT_THAT(error.what(), HasSubstr("600 points"));
    EXPECT_THAT(error.what(), HasSubstr("300 points"));
  }
  const std::vector<CurveFit<2>> fits = FitCurves<2>(cloud);
  ASSERT_EQ(fits.size(), 2u);
  EXPECT_EQ(fits[0].report.input.used, 600);
  EXPECT_EQ(fits[1].report.input.used, 300);
  EXPECT_LT(fits[0].report.error.max, 1e-4);
  const CurveFit<2> second = FitComponent<2>(cloud, 2);
  EXPECT_EQ(second.curve, fits[1].curve);
  EXPECT_EQ(second.outliers.count(), 600);  // the points of the other curve do not count
  EXPECT_EQ(second.report.input.outliers, 0);
  EXPECT_THROW(FitComponent<2>(cloud, 3), std::invalid_argument);
}

TEST(FitCurveShapesTest, RefusesBranchesAndSaysWhere) {
  Eigen::Matrix3Xd points(3, 600);
  for (int k = 0; k < 400; ++k) points.col(k) << k / 100.0, 0, 0;
  for (int k = 0; k < 200; ++k) points.col(400 + k) << 2, (k + 1) / 100.0, 0;
  try {
    FitCurve<2>(Shuffled(Plane(points), 3));
    FAIL() << "a T is no curve";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("branch"));
    EXPECT_THAT(error.what(), HasSubstr("(2"));
  }
}

// An arc of a conic is one or two rational quadratics.
TEST(FitCurveShapesTest, FreeWeightsFindConics) {
  CurveFitOptions options;
  options.degree = 2;
  options.optimize = FreeVariables{.parameters = true, .weights = true};
  for (const double reach : {1.2, 2.3, 3.7}) {
    SCOPED_TRACE(reach);
    const auto ellipse = [&](double t) {
      return Eigen::Vector3d(5 + 3 * std::cos(t), 1.2 * std::sin(t) - 3, 0);
    };
    const CurveFit<2> arc = FitCurve<2>(Plane(AlongCurve(60, 0.3, 0.3 + reach, ellipse)), options);
    EXPECT_LT(arc.report.error.max, 6 * kIterated);
    EXPECT_LE(arc.curve.basis().size(), 4);
    EXPECT_TRUE(std::holds_alternative<EllipseShape>(ClassifyShape(arc.curve)));
    const auto hyperbola = [&](double t) {
      return Eigen::Vector3d(2 * std::cosh(t), 1.1 * std::sinh(t), 0);
    };
    const CurveFit<2> branch =
        FitCurve<2>(Plane(AlongCurve(60, -0.4, reach - 0.4, hyperbola)), options);
    EXPECT_LT(branch.report.error.max, 20 * kIterated);
    EXPECT_TRUE(std::holds_alternative<HyperbolaShape>(ClassifyShape(branch.curve)));
  }
}

TEST(FitCurveShapesTest, ThirtyPerCentOfOutliersHardlyMove) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Eigen::Matrix3Xd helix = Noisy(Helix(2000), 1e-3, seed, 3);
    const CurveFit<3> clean = FitCurve<3>(PointCloud(helix)),
                      dirty = FitCurve<3>(PointCloud(WithOutliers(helix, 0.3, seed)));
    EXPECT_LT(TruthRms(dirty.curve, Helix(40000), false),
              1.5 * TruthRms(clean.curve, Helix(40000), false));
    EXPECT_GT(dirty.report.input.outliers, 500);
    EXPECT_LT(dirty.report.error.max, 0.01);
    EXPECT_GT(dirty.report.error_all.max, 0.1);
  }
}

// Twice the noise on four times the points says as much of the shape.
TEST(FitCurveShapesTest, ControlPointsAreForTheShapeNotForThePoints) {
  const int few =
      FitCurve<3>(PointCloud(Noisy(Helix(2000), 1e-3, 1, 3))).report.geometry.control_points[0];
  const int many =
      FitCurve<3>(PointCloud(Noisy(Helix(8000), 2e-3, 2, 3))).report.geometry.control_points[0];
  EXPECT_NEAR(few, many, 0.25 * few);
}

TEST(FitCurveShapesTest, UnitsPlaceAndDirectionDoNotMatter) {
  const Eigen::Matrix3Xd points = Noisy(Helix(1500), 1e-3, 4, 3);
  const CurveFit<3> fit = FitCurve<3>(PointCloud(points));
  for (const double unit : {1e-6, 1e6}) {
    SCOPED_TRACE(unit);
    const CurveFit<3> scaled = FitCurve<3>(PointCloud(points * unit));
    EXPECT_EQ(scaled.curve.basis().size(), fit.curve.basis().size());
    EXPECT_NEAR(scaled.report.error.rms, unit * fit.report.error.rms, kHalfDigits * unit);
  }
  const CurveFit<3> back = FitCurve<3>(PointCloud(points.rowwise().reverse()));
  EXPECT_NEAR(back.report.error.rms, fit.report.error.rms, 0.01 * fit.report.error.rms);
  EXPECT_NEAR(back.curve.basis().size(), fit.curve.basis().size(), 0.2 * fit.curve.basis().size());
}

// Tangent and squared distances end no higher than point distances.
TEST(FitCurveShapesTest, OtherDistanceModelsComeLower) {
  CurveFitOptions options;
  options.control_points = 24;
  options.optimize = FreeVariables{};
  const PointCloud cloud = Plane(Noisy(Flower(800), 5e-3, 2, 2));
  const double point = FitCurve<2>(cloud, options).report.error.rms;
  for (const CurveDistance distance : {CurveDistance::kTangent, CurveDistance::kSquared}) {
    options.distance = distance;
    EXPECT_LE(FitCurve<2>(cloud, options).report.error.rms, point * (1 + kIterated));
  }
}

}  // namespace batten::internal::fit_curve_shapes_test
