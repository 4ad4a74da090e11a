// SPDX-License-Identifier: MIT
#include "fitting/parameterization/parameterization.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "bent_sheets.h"
#include "tolerances.h"

#include "batten/fitting/solve_linear.h"

namespace batten::internal::parameterization_test {

Eigen::Matrix3d SomeTurn() {
  return Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -2) / 3).toRotationMatrix();
}

// Over the rectangle 3 × 2, turned and far from the origin.
Parameterization OverPlane() {
  Parameterization base;
  base.length_u = 3;
  base.length_v = 2;
  base.plane = PlaneBase{
      .origin = Eigen::Vector3d(50, -20, 7), .axes = SomeTurn(), .length_u = 3, .length_v = 2};
  return base;
}

Parameterization OverSheet(bool exact = false) {
  Parameterization base;
  base.length_u = 3;
  base.length_v = 2;
  base.exact = exact;
  return base;
}

Eigen::Matrix2Xd Places(Eigen::Index count, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> uniform;
  Eigen::Matrix2Xd places(2, count);
  for (auto place : places.colwise()) place << 3 * uniform(engine), 2 * uniform(engine);
  return places;
}

SplineBasis BasisU() { return SplineBasis::Uniform(3, 7, 0, 3); }
SplineBasis BasisV() { return SplineBasis::Uniform(2, 5, 0, 2); }

// Control points of a curved surface that is nowhere singular.
Eigen::Matrix3Xd CurvedNet(unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> uniform(-0.1, 0.1);
  Eigen::Matrix3Xd net(3, 35);
  for (int i = 0; i < 7; ++i) {
    for (int j = 0; j < 5; ++j) {
      net.col(i * 5 + j) << BasisU().Greville(i) + uniform(engine),
          BasisV().Greville(j) + uniform(engine), 4 * uniform(engine);
    }
  }
  return net;
}

FittingProblem WithNetBases(const FittingProblem& problem) {
  return problem.WithBases(BasisU(), BasisV());
}

TEST(ParameterizationTest, ItsProblemHoldsThePointsUnderTheMaskInOrder) {
  const Eigen::Index count = 200;
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Random(3, count);
  PointCloud cloud(points);
  cloud.set_weights(Eigen::VectorXd::LinSpaced(count, 1, 9));
  PointMask mask = PointMask::Constant(count, true);
  for (Eigen::Index k = 0; k < count; k += 3) mask[k] = false;
  for (Parameterization base : {OverPlane(), OverSheet()}) {
    base.parameters = Places(count, 1);
    const FittingProblem problem = base.ProblemOf(cloud, mask, 3, 2, 1e-4);
    ASSERT_EQ(problem.size(), mask.count());
    EXPECT_EQ(problem.basis_u(), SplineBasis::Uniform(3, 4, 0, 3));
    EXPECT_EQ(problem.basis_v(), SplineBasis::Uniform(2, 3, 0, 2));
    EXPECT_EQ(problem.smoothing(), 1e-4);
    const FittingData& data = problem.data();
    ASSERT_EQ(data.values.rows(), base.plane ? 1 : 3);
    Eigen::Index next = 0;
    for (Eigen::Index k = 0; k < count; ++k) {
      if (!mask[k]) continue;
      EXPECT_EQ(data.parameters.col(next), base.parameters.col(k));
      if (base.plane) {
        EXPECT_NEAR(data.values(0, next), base.plane->ToFrame(points)(2, k), 60 * kRounding);
      } else {
        EXPECT_EQ(data.values.col(next), points.col(k));
      }
      EXPECT_NEAR(
          data.weights[next] / data.weights[0], cloud.weights()[k] / cloud.weights()[1], kRounding);
      ++next;
    }
    EXPECT_NEAR(data.weights.mean(), 1, kRounding);
    EXPECT_EQ(base.ProblemOf(PointCloud(points), mask, 3, 2, 0).data().weights.size(), 0);
  }
}

TEST(ParameterizationTest, ItsSurfaceStandsOverThePlaneAtTheParameters) {
  const Parameterization base = OverPlane();
  const Eigen::MatrixXd heights = CurvedNet(2).row(2);
  const NurbsSurface surface = base.Surface(BasisU(), BasisV(), heights);
  const NurbsSurface flat(BasisU(), BasisV(), Eigen::Vector3d::UnitZ() * heights);  // heights alone
  const Eigen::Matrix2Xd places = Places(50, 3);
  for (const auto& place : places.colwise()) {
    const Eigen::Vector3d local = base.plane->ToFrame(surface.At(place[0], place[1]));
    EXPECT_LE((local.head<2>() - place).norm(), 60 * kRounding);
    EXPECT_NEAR(local[2], flat.At(place[0], place[1])[2], 60 * kRounding);
  }
  const Eigen::Matrix3Xd net = CurvedNet(2);
  EXPECT_EQ(OverSheet().Surface(BasisU(), BasisV(), net), NurbsSurface(BasisU(), BasisV(), net));
}

// Points off a surface by so much along its normal and along itself.
TEST(ParameterizationTest, ResidualsAreTheSignedPartAlongTheNormal) {
  std::mt19937_64 engine(4);
  std::normal_distribution<double> normal(0, 0.01);
  const Eigen::Matrix3Xd net = CurvedNet(4);
  const NurbsSurface surface(BasisU(), BasisV(), net);
  const Eigen::Index count = 3000;
  const Eigen::Matrix2Xd places = Places(count, 4);
  Eigen::Matrix3Xd points(3, count);
  Eigen::VectorXd off(count), along(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const SurfaceJet jet = surface.JetAt(places(0, k), places(1, k));
    off[k] = normal(engine);
    along[k] = normal(engine);
    points.col(k) =
        jet.point + off[k] * jet.du.cross(jet.dv).normalized() + along[k] * jet.du.normalized();
  }
  const PointMask all = PointMask::Constant(count, true);
  ThreadPool one(1), three(3);
  for (const double unit : {1e-6, 1.0, 1e6}) {
    SCOPED_TRACE("unit " + std::to_string(unit));
    for (const bool exact : {false, true}) {
      Parameterization base = OverSheet(exact);
      base.parameters = places;
      const FittingProblem problem =
          WithNetBases(base.ProblemOf(PointCloud(unit * points), all, 3, 2, 0));
      const Eigen::VectorXd residuals = base.Residuals(problem, unit * net, one);
      const Eigen::VectorXd expected =
          exact ? (off.array().square() + along.array().square()).sqrt().matrix().eval() : off;
      EXPECT_LE((residuals / unit - expected).cwiseAbs().maxCoeff(), 10 * kRounding);
      EXPECT_EQ(residuals, base.Residuals(problem, unit * net, three));
    }
  }
}

TEST(ParameterizationTest, ResidualsOverAPlaneAreDistancesFromASlope) {
  // Heights are linear, so that the surface is a plane: its distances are known.
  Parameterization base = OverPlane();
  const Eigen::Index count = 500;
  base.parameters = Places(count, 5);
  const Eigen::VectorXd off = Eigen::VectorXd::Random(count);
  const double slope_u = 0.7, slope_v = -1.9;
  Eigen::Matrix3Xd local(3, count);
  local.topRows<2>() = base.parameters;
  local.row(2) = Eigen::RowVector2d(slope_u, slope_v) * base.parameters + off.transpose();
  const Eigen::Matrix3Xd points = (base.plane->axes * local).colwise() + base.plane->origin;
  Eigen::MatrixXd heights(1, 35);
  for (int i = 0; i < 7; ++i) {
    for (int j = 0; j < 5; ++j)
      heights(0, i * 5 + j) = slope_u * BasisU().Greville(i) + slope_v * BasisV().Greville(j);
  }
  ThreadPool pool(2);
  const FittingProblem problem =
      WithNetBases(base.ProblemOf(PointCloud(points), PointMask::Constant(count, true), 3, 2, 0));
  const double cosine = 1 / std::sqrt(1 + slope_u * slope_u + slope_v * slope_v);
  EXPECT_LE((base.Residuals(problem, heights, pool) - cosine * off).cwiseAbs().maxCoeff(),
            60 * kRounding);
}

// The plane through so long sides, with an angle between them.
NurbsSurface Sheared(double stretch_u, double stretch_v, double angle, double unit = 1) {
  const Eigen::Vector3d u = stretch_u * SomeTurn().col(0);
  const Eigen::Vector3d v =
      stretch_v * (std::cos(angle) * SomeTurn().col(0) + std::sin(angle) * SomeTurn().col(1));
  const SplineBasis basis_u = SplineBasis::Uniform(3, 7, 0, 3 * unit);
  const SplineBasis basis_v = SplineBasis::Uniform(2, 5, 0, 2 * unit);
  Eigen::Matrix3Xd net(3, 35);
  for (int i = 0; i < 7; ++i) {
    for (int j = 0; j < 5; ++j)
      net.col(i * 5 + j) = basis_u.Greville(i) * u + basis_v.Greville(j) * v;
  }
  net.colwise() += unit * Eigen::Vector3d(5, -3, 2);
  return NurbsSurface(basis_u, basis_v, net);
}

TEST(DistortionAtTest, IsZeroOfIsometriesAndFollowsAStretch) {
  const double right = std::numbers::pi / 2;
  std::mt19937_64 engine(6);
  std::uniform_real_distribution<double> stretch(0.3, 3), angle(0.3, 2.8);
  for (const double unit : {1e-6, 1.0, 1e6}) {
    SCOPED_TRACE("unit " + std::to_string(unit));
    const Eigen::Matrix2Xd places = unit * Places(300, 6);
    // Half of the digits: a square root of the difference of nearly equal squares.
    EXPECT_LE(DistortionAt(Sheared(1, 1, right, unit), places), kHalfDigits);
    for (int round = 0; round < 10; ++round) {
      const double a = stretch(engine), b = stretch(engine), between = angle(engine);
      const Eigen::Matrix2d map{{a, b * std::cos(between)}, {0, b * std::sin(between)}};
      const Eigen::Vector2d stretches = Eigen::JacobiSVD<Eigen::Matrix2d>(map).singularValues();
      EXPECT_NEAR(DistortionAt(Sheared(a, b, between, unit), places),
                  std::sqrt((stretches.array() - 1).square().mean()),
                  kHalfDigits);
    }
  }
}

TEST(DistortionAtTest, IsTheMeanOverTheParametersGiven) {
  // One half is isometric, the other twice as long in one direction.
  const SplineBasis lines = SplineBasis::Uniform(1, 3, 0, 2),
                    across = SplineBasis::Uniform(1, 2, 0, 1);
  Eigen::Matrix3Xd net(3, 6);
  for (int i = 0; i < 3; ++i) {
    net.col(2 * i) << (i == 2 ? 3 : i), 0, 0;
    net.col(2 * i + 1) << (i == 2 ? 3 : i), 1, 0;
  }
  const NurbsSurface surface(lines, across, net);
  for (const Eigen::Index count : {1000, 50000}) {
    for (const double share : {0.0, 0.25, 1.0}) {
      SCOPED_TRACE(std::to_string(count) + " places, share " + std::to_string(share));
      Eigen::Matrix2Xd places(2, count);
      for (Eigen::Index k = 0; k < count; ++k)
        places.col(k) << (static_cast<double>(k) < share * static_cast<double>(count) ? 1.5 : 0.5),
            0.5;
      EXPECT_NEAR(DistortionAt(surface, places), std::sqrt(share / 2), 1e-3);
    }
  }
  EXPECT_EQ(DistortionAt(surface, Eigen::Matrix2Xd(2, 0)), 0);
}

TEST(DistortionAtTest, IsNearlyZeroOfADevelopableSheetAtItsLengths) {
  ThreadPool pool(2);
  const BentSheet sheet = ArcSheet(200, 1.5);
  const SheetPoints cloud = PointsOn(sheet, {.count = 4000});
  for (const double stretch : {1.0, 1.1}) {
    Parameterization base;
    base.length_u = 200 * std::numbers::pi / 180 / stretch;
    base.length_v = 1.5;
    base.parameters.resize(2, 4000);
    for (Eigen::Index k = 0; k < 4000; ++k) {
      base.parameters.col(k) = sheet.flat(cloud.parameters(0, k), cloud.parameters(1, k))
                                   .cwiseQuotient(Eigen::Vector2d(stretch, 1));
    }
    const FittingProblem problem =
        base.ProblemOf(PointCloud(cloud.points), PointMask::Constant(4000, true), 3, 3, 1e-9)
            .WithBases(SplineBasis::Uniform(3, 15, 0, base.length_u),
                       SplineBasis::Uniform(3, 5, 0, base.length_v));
    const NurbsSurface surface =
        base.Surface(problem.basis_u(), problem.basis_v(), SolveLinear(problem, pool).coefficients);
    // Twelve cells of 17 degrees: the slope of a cubic spline is off by some 0.3³ / 24.
    EXPECT_NEAR(DistortionAt(surface, base.parameters), (stretch - 1) / std::sqrt(2), 2e-3);
  }
}

}  // namespace batten::internal::parameterization_test
