// SPDX-License-Identifier: MIT
#include "fitting/joint/harmonic_reparameterization.h"

#include <gtest/gtest.h>

#include <cmath>

#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::harmonic_reparameterization_test {

// Heights over [0, 2] × [0, 1], bicubic with 20 × 20 control points.
template <typename Height>
NurbsSurface Over(Height height) {
  const SplineBasis u = SplineBasis::Uniform(3, 20, 0, 2), v = SplineBasis::Uniform(3, 20, 0, 1);
  Eigen::Matrix3Xd net(3, 400);
  for (int i = 0; i < 20; ++i) {
    for (int j = 0; j < 20; ++j)
      net.col(20 * i + j) << u.Greville(i), v.Greville(j), height(u.Greville(i), v.Greville(j));
  }
  return NurbsSurface(u, v, net);
}

double Wall(double u, double) { return 3 * std::tanh((u - 1) / 0.1); }

Eigen::Matrix2Xd RandomParameters(unsigned seed, int count) {
  RandomSplines random(seed);
  Eigen::Matrix2Xd parameters(2, count);
  for (auto p : parameters.colwise()) p << random.Real(0, 2), random.Real(0, 1);
  return parameters;
}

// Its parameters are lengths at right angles.
TEST(ReparameterizeHarmonicallyTest, ChangeNothingOfAPlane) {
  ThreadPool pool(2);
  const ReparameterizeHarmonically spread(Over([](double, double v) { return 4 - 3 * v; }), pool);
  EXPECT_NEAR(spread.unevenness(), 1, 1e-9);
  const Eigen::Matrix2Xd parameters = RandomParameters(1, 500);
  EXPECT_LE((spread(parameters) - parameters).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(ReparameterizeHarmonicallyTest, LeaveSidesAndCornersWhereTheyAre) {
  ThreadPool pool(1);
  const ReparameterizeHarmonically spread(
      Over([](double u, double v) { return std::sin(9 * u * v); }), pool);
  for (double s = 0; s <= 1; s += 0.05) {
    Eigen::Matrix2Xd sides(2, 4);
    sides << 0, 2, 2 * s, 2 * s, s, s, 0, 1;
    const Eigen::Matrix2Xd moved = spread(sides);
    EXPECT_EQ(moved(0, 0), 0);
    EXPECT_EQ(moved(0, 1), 2);
    EXPECT_EQ(moved(1, 2), 0);
    EXPECT_EQ(moved(1, 3), 1);
  }
}

// Along a surface that bends one way only, harmonic parameters are arc length.
TEST(ReparameterizeHarmonicallyTest, AreArcLengthAcrossAWall) {
  ThreadPool pool(1);
  const NurbsSurface wall = Over(Wall);
  const ReparameterizeHarmonically spread(wall, pool);
  EXPECT_GT(spread.unevenness(), 4);
  double length = 0, whole = 0;
  constexpr int kSteps = 4000;
  Eigen::VectorXd along(kSteps + 1);
  for (int k = 0; k <= kSteps; ++k) {
    along[k] = whole;
    whole += wall.JetAt(2 * (k + 0.5) / kSteps, 0.5).du.norm() * 2 / kSteps;
  }
  for (int k = 0; k <= kSteps; k += 100) {
    length = along[k];
    const Eigen::Matrix2Xd moved = spread(Eigen::Vector2d(2.0 * k / kSteps, 0.5));
    // An element is 1/40 wide, and the speed is taken in its middle.
    EXPECT_NEAR(moved(0, 0), 2 * length / whole, 0.01) << k;
    EXPECT_NEAR(moved(1, 0), 0.5, 1e-9);
  }
}

// A cup half as deep as it is wide; much deeper ones press their bottom into less than an element.
TEST(ReparameterizeHarmonicallyTest, KeepTheOrderOfWhatLiesBeside) {
  ThreadPool pool(1);
  const ReparameterizeHarmonically spread(
      Over([](double u, double v) {
        return 0.15 * std::tanh((std::hypot(u - 1, v - 0.5) - 0.3) / 0.1);
      }),
      pool);
  for (double v = 0.025; v < 1; v += 0.05) {
    double last = -1;
    for (int k = 0; k <= 160; ++k) {
      const double now = spread(Eigen::Vector2d(2.0 * k / 160, v))(0, 0);
      EXPECT_GT(now, last);
      last = now;
    }
  }
}

TEST(ReparameterizeHarmonicallyTest, StayInTheDomainAndAreFiniteOnWhatIsNoSurface) {
  ThreadPool pool(1);
  const SplineBasis b = SplineBasis::Uniform(2, 5, -1, 0.3);
  const Eigen::Matrix3Xd point = Eigen::Matrix3Xd::Ones(3, 25);
  Eigen::Matrix3Xd line = point;
  for (int k = 0; k < 25; ++k) line.col(k) *= k;
  RandomSplines random(3);
  Eigen::Matrix2Xd parameters(2, 200);
  for (double& x : parameters.reshaped()) x = random.Real(-1, 0.3);
  for (const Eigen::Matrix3Xd& net : {point, line}) {
    const Eigen::Matrix2Xd moved =
        ReparameterizeHarmonically(NurbsSurface(b, b, net), pool)(parameters);
    EXPECT_TRUE(moved.allFinite());
    EXPECT_GE(moved.minCoeff(), -1);
    EXPECT_LE(moved.maxCoeff(), 0.3);
  }
}

}  // namespace batten::internal::harmonic_reparameterization_test
