// SPDX-License-Identifier: MIT
#include "fitting/constraints/symmetric_cloud.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "batten/fitting/solve_linear.h"
#include "batten/geometry/knot_vectors.h"
#include "fitting/constraints/symmetric_net.h"
#include "fitting/least_squares/fitting_bases.h"
#include "random_splines.h"
#include "refusal.h"
#include "tolerances.h"

namespace batten::internal::symmetric_cloud_test {

// The largest distance by which SymmetricNet moves a control point.
double Asymmetry(const NurbsSurface& surface, Direction direction, const MirrorPlane& plane) {
  return (SymmetricNet(surface, direction, plane).control_points() - surface.control_points())
      .colwise()
      .norm()
      .maxCoeff();
}

// Half a sheet, x ≥ 0 in its own frame, bent symmetrically, with the frame's place in the world.
struct HalfSheet {
  Eigen::Matrix3d turn;
  Eigen::Vector3d place;
  MirrorPlane plane;
  PointCloud cloud;
  Eigen::Matrix2Xd parameters;  // (x, y) of the points
};

HalfSheet MakeHalf(RandomSplines& random, int count, double gap, double unit) {
  HalfSheet half;
  half.turn = Eigen::AngleAxisd(random.Real(-3, 3), random.Vector(1).normalized());
  half.place = unit * random.Vector(10);
  half.plane = {half.turn.col(0), half.turn.col(0).dot(half.place)};
  half.parameters.resize(2, count);
  Eigen::Matrix3Xd points(3, count);
  for (int k = 0; k < count; ++k) {
    const double x = gap + random.Real(0, 1), y = random.Real(-0.7, 0.7);
    half.parameters.col(k) << x, y;
    points.col(k) = half.place +
                    unit * (half.turn * Eigen::Vector3d(x, y, 0.4 * x * x + 0.1 * std::sin(3 * y)));
  }
  half.cloud = PointCloud(points, unit * Eigen::Vector3d(100, -200, 50));
  half.plane.offset += half.plane.normal.dot(half.cloud.origin());
  return half;
}

PointMask All(const PointCloud& cloud) { return PointMask::Constant(cloud.size(), true); }

TEST(SymmetricCloudTest, TwinsAreMirrorImagesOfOneAnother) {
  RandomSplines random(1);
  HalfSheet half = MakeHalf(random, 200, 0, 1);
  half.cloud.set_weights(Eigen::VectorXd::LinSpaced(200, 1, 2));
  half.cloud.set_normals(Eigen::Matrix3Xd::Random(3, 200).colwise().normalized());
  const SymmetricCloud both = WithMirrorImage(half.cloud, half.plane);
  ASSERT_EQ(both.cloud.size(), 400);
  for (Eigen::Index k = 0; k < 400; ++k) {
    const Eigen::Index twin = both.twins[static_cast<size_t>(k)];
    EXPECT_EQ(both.twins[static_cast<size_t>(twin)], k);
    EXPECT_LE((half.plane.Mirrored(both.cloud.World(k)) - both.cloud.World(twin)).norm(),
              kRounding * 100);
    EXPECT_EQ(both.cloud.weights()[k], both.cloud.weights()[twin]);
    EXPECT_NEAR(half.plane.normal.dot(both.cloud.normals().col(k)),
                -half.plane.normal.dot(both.cloud.normals().col(twin)),
                kRounding);
  }
}

TEST(SymmetricCloudTest, APointInThePlaneIsItsOwnTwin) {
  Eigen::Matrix3Xd points(3, 2);
  points << 0, 1, 2, 2, 3, 3;
  const SymmetricCloud both = WithMirrorImage(PointCloud(points), {Eigen::Vector3d::UnitX(), 0});
  EXPECT_EQ(both.cloud.size(), 3);
  EXPECT_EQ(both.twins, (std::vector<Eigen::Index>{0, 2, 1}));
  EXPECT_THROW(WithMirrorImage(PointCloud(points), {Eigen::Vector3d(1, 1, 0), 0}),
               std::invalid_argument);
}

// Parameters of a base that knows nothing of the symmetry: turned, moved and bent a little.
Parameterization BentBase(RandomSplines& random,
                          const HalfSheet& half,
                          const SymmetricCloud& both,
                          double bend) {
  const Eigen::Rotation2Dd turn(random.Real(-3, 3));
  Parameterization base;
  base.parameters.resize(2, both.cloud.size());
  for (Eigen::Index k = 0; k < both.cloud.size(); ++k) {
    Eigen::Vector2d at = half.parameters.col(k % half.cloud.size());
    if (k >= half.cloud.size()) at[0] = -at[0];
    at += bend * Eigen::Vector2d(std::sin(2 * at[1] + 1), std::cos(at[0] + 0.3));
    base.parameters.col(k) = turn * at;
  }
  const Eigen::Vector2d low = base.parameters.rowwise().minCoeff();
  base.parameters.colwise() -= low;
  base.parameters.array() += 0.01;
  base.length_u = base.parameters.row(0).maxCoeff() + 0.01;
  base.length_v = base.parameters.row(1).maxCoeff() + 0.01;
  return base;
}

TEST(SymmetricCloudTest, ParametersOfAnyBaseBecomeSymmetric) {
  ThreadPool pool(1);
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    RandomSplines random(seed);
    const double unit = std::array{1.0, 1e-6, 1e6}[seed % 3];
    const HalfSheet half = MakeHalf(random, 800, 0, unit);
    const SymmetricCloud both = WithMirrorImage(half.cloud, half.plane);
    const Parameterization base = BentBase(random, half, both, 0.02);
    const MirrorPlane local = half.plane.From(both.cloud.origin());
    const SymmetricBase symmetric =
        SymmetricParameters(base, both.cloud, All(both.cloud), local, both.twins);
    const int row = symmetric.reflected == Direction::kU ? 0 : 1;
    const double length = row == 0 ? symmetric.base.length_u : symmetric.base.length_v;
    const Eigen::Matrix2Xd& at = symmetric.base.parameters;
    for (Eigen::Index k = 0; k < both.cloud.size(); ++k) {
      const Eigen::Index twin = both.twins[static_cast<size_t>(k)];
      EXPECT_NEAR(at(row, k) + at(row, twin), length, 1e-15 * length);
      EXPECT_EQ(at(1 - row, k), at(1 - row, twin));
    }
    EXPECT_GE(at.minCoeff(), 0);
    EXPECT_LE(at.row(0).maxCoeff(), symmetric.base.length_u);
    EXPECT_LE(at.row(1).maxCoeff(), symmetric.base.length_v);
    // They are still those of the base, turned: distances stay, to what bending took.
    for (int k = 0; k < 50; ++k) {
      const Eigen::Index a = random.Integer(0, 1599), b = random.Integer(0, 1599);
      EXPECT_NEAR((at.col(a) - at.col(b)).norm(),
                  (base.parameters.col(a) - base.parameters.col(b)).norm(),
                  4 * 0.02);
    }
    // A fit over them is symmetric but for rounding, which goes with the net's symmetry.
    const FittingProblem problem = symmetric.base.ProblemOf(both.cloud, All(both.cloud), 3, 3, 1e-6)
                                       .WithBases(FittingBasis(3, 6, 0, symmetric.base.length_u),
                                                  FittingBasis(3, 5, 0, symmetric.base.length_v));
    const NurbsSurface fit(
        problem.basis_u(), problem.basis_v(), SolveLinear(problem, pool).coefficients);
    const double size = both.cloud.points().colwise().norm().maxCoeff();
    EXPECT_LE(Asymmetry(fit, symmetric.reflected, local), kIterated * size);
    const NurbsSurface exact = SymmetricNet(fit, symmetric.reflected, local);
    for (int k = 0; k < 50; ++k) {
      const double t = random.Real(0, 1) * length;
      const double s =
          random.Real(0, 1) * (row == 0 ? symmetric.base.length_v : symmetric.base.length_u);
      const Eigen::Vector3d one = row == 0 ? exact.At(t, s) : exact.At(s, t),
                            other = row == 0 ? exact.At(length - t, s) : exact.At(s, length - t);
      EXPECT_LE((local.Mirrored(one) - other).norm(), 1e-14 * size);
    }
  }
}

TEST(SymmetricCloudTest, APlaneBaseIsTurnedUpright) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    RandomSplines random(seed);
    const HalfSheet half = MakeHalf(random, 500, 0, 1);
    const SymmetricCloud both = WithMirrorImage(half.cloud, half.plane);
    Parameterization base;
    base.plane.emplace();
    base.plane->axes = half.turn *
                       Eigen::AngleAxisd(random.Real(-0.2, 0.2), random.Vector(1).normalized()) *
                       Eigen::AngleAxisd(random.Real(-3, 3), Eigen::Vector3d::UnitZ());
    base.plane->origin = half.place + random.Vector(1);
    Eigen::Matrix3Xd frame = base.plane->ToFrame(both.cloud.points());
    base.plane->origin += base.plane->axes.leftCols<2>() *
                          (frame.topRows<2>().rowwise().minCoeff().array() - 0.05).matrix();
    frame = base.plane->ToFrame(both.cloud.points());
    base.parameters = frame.topRows<2>();
    base.length_u = base.plane->length_u = frame.row(0).maxCoeff() + 0.05;
    base.length_v = base.plane->length_v = frame.row(1).maxCoeff() + 0.05;
    const MirrorPlane local = half.plane.From(both.cloud.origin());
    const SymmetricBase symmetric =
        SymmetricParameters(base, both.cloud, All(both.cloud), local, both.twins);
    const PlaneBase& plane = *symmetric.base.plane;
    EXPECT_LE((plane.axes.transpose() * plane.axes - Eigen::Matrix3d::Identity()).norm(),
              kRounding);
    EXPECT_NEAR(plane.axes.determinant(), 1, kRounding);
    const Eigen::Matrix3Xd after = plane.ToFrame(both.cloud.points());
    EXPECT_LE((after.topRows<2>() - symmetric.base.parameters).cwiseAbs().maxCoeff(),
              100 * kRounding);
    const int row = symmetric.reflected == Direction::kU ? 0 : 1;
    const double length = row == 0 ? symmetric.base.length_u : symmetric.base.length_v;
    for (Eigen::Index k = 0; k < both.cloud.size(); ++k) {
      const Eigen::Index twin = both.twins[static_cast<size_t>(k)];
      EXPECT_NEAR(symmetric.base.parameters(row, k) + symmetric.base.parameters(row, twin),
                  length,
                  1e-14 * length);
      EXPECT_NEAR(after(2, k), after(2, twin), 100 * kRounding);
    }
  }
}

// Half a tube, cut along or across its axis, over turned angles.
TEST(SymmetricCloudTest, ReflectsAnglesAndLengthsOfATube) {
  for (const bool across : {false, true}) {
    SCOPED_TRACE(across ? "across" : "along");
    RandomSplines random(3);
    const int count = 900;
    Eigen::Matrix3Xd points(3, count);
    for (int k = 0; k < count; ++k) {
      const double angle = across ? random.Real(0, 2 * std::numbers::pi)
                                  : random.Real(-std::numbers::pi / 2, std::numbers::pi / 2);
      points.col(k) << std::cos(angle), std::sin(angle),
          across ? random.Real(0, 2) : random.Real(-2, 2);
    }
    const MirrorPlane plane{across ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX(), 0};
    const SymmetricCloud both = WithMirrorImage(PointCloud(points), plane);
    Parameterization base;
    base.periodic_u = true;
    base.length_u = 2 * std::numbers::pi;
    base.length_v = 4.2;
    base.parameters.resize(2, both.cloud.size());
    for (Eigen::Index k = 0; k < both.cloud.size(); ++k) {
      const Eigen::Vector3d p = both.cloud.points().col(k);
      const double angle = std::atan2(p[1], p[0]) + 1.234 + 0.01 * std::sin(2 * p[1] + p[0]);
      base.parameters.col(k) << angle - base.length_u * std::floor(angle / base.length_u),
          p[2] + 2.1 + 0.01 * p[0];
    }
    const SymmetricBase symmetric =
        SymmetricParameters(base, both.cloud, All(both.cloud), plane, both.twins);
    EXPECT_EQ(symmetric.reflected, across ? Direction::kV : Direction::kU);
    const int row = across ? 1 : 0;
    const double length = across ? symmetric.base.length_v : symmetric.base.length_u;
    const Eigen::Matrix2Xd& at = symmetric.base.parameters;
    for (Eigen::Index k = 0; k < both.cloud.size(); ++k) {
      const Eigen::Index twin = both.twins[static_cast<size_t>(k)];
      const double sum = at(row, k) + at(row, twin);
      EXPECT_LE(across ? std::abs(sum - length) : std::abs(std::remainder(sum, length)),
                1e-14 * length);
      EXPECT_EQ(at(1 - row, k), at(1 - row, twin));
      EXPECT_LE(std::abs(std::remainder(
                    at(0, k) - base.parameters(0, k) - (at(0, 0) - base.parameters(0, 0)),
                    base.length_u)),
                0.1);
    }
    EXPECT_GE(at.minCoeff(), 0);
    EXPECT_LE(at.row(0).maxCoeff(), symmetric.base.length_u);
    EXPECT_LE(at.row(1).maxCoeff(), symmetric.base.length_v);
    ThreadPool pool(1);
    const FittingProblem problem = symmetric.base.ProblemOf(both.cloud, All(both.cloud), 3, 3, 1e-6)
                                       .WithBases(PeriodicUniformKnots(3, 12, 0, base.length_u),
                                                  FittingBasis(3, 3, 0, symmetric.base.length_v));
    const NurbsSurface fit(
        problem.basis_u(), problem.basis_v(), SolveLinear(problem, pool).coefficients);
    EXPECT_LE(Asymmetry(fit, symmetric.reflected, plane), kIterated);
    EXPECT_LE(Asymmetry(SymmetricNet(fit, symmetric.reflected, plane), symmetric.reflected, plane),
              1e-15);
  }
}

std::string Refusal(const Parameterization& base,
                    const SymmetricCloud& both,
                    const MirrorPlane& plane) {
  return internal::RefusalOf(
      [&] { SymmetricParameters(base, both.cloud, All(both.cloud), plane, both.twins); }, "");
}

TEST(SymmetricCloudTest, WhatIsNoReflectionIsRefusedWithTheReason) {
  RandomSplines random(2);
  const HalfSheet half = MakeHalf(random, 300, 0, 1);
  const SymmetricCloud both = WithMirrorImage(half.cloud, half.plane);
  Parameterization base = BentBase(random, half, both, 0);
  Parameterization layers = base;
  layers.parameters.rightCols(300) = layers.parameters.leftCols(300);
  EXPECT_THAT(Refusal(layers, both, half.plane), testing::HasSubstr("second layer"));
  Parameterization other = base;
  for (double& at : other.parameters.rightCols(300).reshaped()) at = random.Real(0, 1);
  EXPECT_NE(Refusal(other, both, half.plane), "");
  const HalfSheet apart = MakeHalf(random, 300, 1, 1);
  const SymmetricCloud far = WithMirrorImage(apart.cloud, apart.plane);
  EXPECT_THAT(Refusal(BentBase(random, apart, far, 0), far, apart.plane),
              testing::HasSubstr("gap"));
}

}  // namespace batten::internal::symmetric_cloud_test
