// SPDX-License-Identifier: MIT
#include "fitting/parameterization/plane_base.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <string>

#include "random_splines.h"
#include "refusal.h"
#include "tolerances.h"

namespace batten::internal::plane_base_test {

using std::numbers::pi;
using testing::HasSubstr;

Eigen::Matrix3d RandomTurn(RandomSplines& random) {
  Eigen::Matrix3d turn = random.Orthogonal();
  if (turn.determinant() < 0) turn.col(0) *= -1;
  return turn;
}

Eigen::Matrix3Xd Points(int count, const std::function<Eigen::Vector3d()>& point) {
  Eigen::Matrix3Xd points(3, count);
  for (int k = 0; k < count; ++k) points.col(k) = point();
  return points;
}

// Heights over the rectangle [0, length] × [0, width].
Eigen::Matrix3Xd Sheet(RandomSplines& random,
                       int count,
                       double length,
                       double width,
                       const std::function<double(double, double)>& height) {
  return Points(count, [&] {
    const double x = random.Real(0, length), y = random.Real(0, width);
    return Eigen::Vector3d(x, y, height(x, y));
  });
}

PlaneBase Find(const Eigen::Matrix3Xd& points, double spacing, double margin = 0) {
  ThreadPool one(1);
  return FindPlaneBase(points, NeighbourIndex(points), spacing, margin, 1, one);
}

double AngleTo(const PlaneBase& base, const Eigen::Vector3d& axis) {
  return std::acos(std::min(1.0, std::abs(base.axes.col(2).dot(axis))));
}

void ExpectHoldsAll(const PlaneBase& base, const Eigen::Matrix3Xd& points) {
  const Eigen::Matrix3Xd local = base.ToFrame(points);
  const double rounding =
      kRounding * (points.cwiseAbs().maxCoeff() + base.length_u + base.length_v);
  EXPECT_GE(local.topRows<2>().minCoeff(), -rounding);
  EXPECT_LE(local.row(0).maxCoeff(), base.length_u + rounding);
  EXPECT_LE(local.row(1).maxCoeff(), base.length_v + rounding);
}

std::string Refusal(const Eigen::Matrix3Xd& points) {
  return internal::RefusalOf([&] { Find(points, 0.1); });
}

TEST(FindPlaneBaseTest, HoldsAllPointsInItsRectangleAndNoMore) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const double scale = random.Logarithmic(1e-3, 1e3), margin = random.Coin() ? 0 : 0.1 * scale;
    const Eigen::Matrix3Xd flat =
        Sheet(random, random.Integer(20, 500), 3, 1, [](double x, double y) {
          return 0.2 * std::sin(x) * y;
        });
    const Eigen::Matrix3Xd points =
        ((scale * RandomTurn(random)) * flat).colwise() + random.Vector(10 * scale);
    const PlaneBase base = Find(points, 0.1 * scale, margin);
    ExpectHoldsAll(base, points);
    const Eigen::Matrix3Xd local = base.ToFrame(points);
    const double rounding = kRounding * points.cwiseAbs().maxCoeff();
    EXPECT_NEAR(local.row(0).minCoeff(), margin, rounding);
    EXPECT_NEAR(local.row(1).minCoeff(), margin, rounding);
    EXPECT_NEAR(base.length_u - local.row(0).maxCoeff(), margin, rounding);
    EXPECT_NEAR(base.length_v - local.row(1).maxCoeff(), margin, rounding);
  }
}

TEST(FindPlaneBaseTest, HasARightHandedFrame) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const Eigen::Matrix3Xd points =
        RandomTurn(random) * Sheet(random, 200, 2, 1, [](double x, double) { return 0.1 * x * x; });
    const PlaneBase base = Find(points, 0.1);
    EXPECT_LE((base.axes.transpose() * base.axes - Eigen::Matrix3d::Identity()).norm(), kRounding);
    EXPECT_NEAR(base.axes.determinant(), 1, kRounding);
  }
}

TEST(FindPlaneBaseTest, FindsTheSmallestRectangleOfATurnedOne) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const double length = random.Real(2, 8), turn = random.Real(0, pi);
    Eigen::Matrix3Xd points = Sheet(random, 1000, length, 1, [](double, double) { return 0; });
    points.leftCols<4>() << 0, length, length, 0, 0, 0, 1, 1, 0, 0, 0, 0;
    points = (Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()).toRotationMatrix() * points).eval();
    const PlaneBase base = Find(points, 0.1);
    const double area = base.length_u * base.length_v;
    // One parallel to the axes is taken when it is nearly as small.
    const Eigen::Vector3d box = points.rowwise().maxCoeff() - points.rowwise().minCoeff();
    const bool parallel = std::abs(area - box[0] * box[1]) < kRounding * area;
    EXPECT_TRUE(std::abs(area - length) < kRounding * area || (parallel && area < 1.15 * length))
        << "area " << area << " in place of " << length;
  }
}

TEST(FindPlaneBaseTest, KeepsHeightFieldsOverThePlan) {
  RandomSplines random(1);
  // A steady slope of a half, seen best from 27° off the vertical.
  const Eigen::Matrix3Xd points =
      Sheet(random, 2000, 10, 10, [](double x, double y) { return 0.5 * x + 0.2 * std::sin(y); });
  const PlaneBase base = Find(points, 0.22);
  EXPECT_EQ(base.axes, Eigen::Matrix3d::Identity());
}

TEST(FindPlaneBaseTest, PrefersYWhereZDoesNotServe) {
  RandomSplines random(2);
  // A slightly tilted wall.
  const Eigen::Matrix3Xd points = Points(1000, [&] {
    const double x = random.Real(0, 4), z = random.Real(0, 3);
    return Eigen::Vector3d(x, 0.1 * x + 0.05 * z, z);
  });
  EXPECT_EQ(Find(points, 0.1).axes.col(2), Eigen::Vector3d::UnitY());
}

TEST(FindPlaneBaseTest, FindsTheAxisOfASphereCapInAnyPose) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    RandomSplines random(seed);
    const double opening = random.Real(0.5, 1.2);
    SCOPED_TRACE("seed " + std::to_string(seed) + ", opening " + std::to_string(opening));
    Eigen::Matrix3d turn;
    // Far from every coordinate axis, so that none is nearly as good.
    do {
      turn = RandomTurn(random);
    } while (turn.col(2).cwiseAbs().maxCoeff() > 0.7);
    const Eigen::Matrix3Xd cap = Points(4000, [&] {
      const double z = random.Real(std::cos(opening), 1), angle = random.Real(0, 2 * pi);
      const double r = std::sqrt(1 - z * z);
      return Eigen::Vector3d(r * std::cos(angle), r * std::sin(angle), z);
    });
    const PlaneBase base = Find(turn * cap, 0.04);
    EXPECT_LE(AngleTo(base, turn.col(2)), 5 * pi / 180);
    // 95 % of a cap by area lie within the cosine 1 − 0.95 (1 − cos(opening)).
    EXPECT_NEAR(base.steepness, std::acos(1 - 0.95 * (1 - std::cos(opening))), 5 * pi / 180);
    EXPECT_EQ(base.overlap, 0);
  }
}

TEST(FindPlaneBaseTest, TurnsWithThePoints) {
  RandomSplines random(3);
  const Eigen::Matrix3Xd points =
      Sheet(random, 1000, 4, 2, [](double x, double y) { return 0.1 * x * y; });
  const PlaneBase flat = Find(points, 0.09);
  for (unsigned seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines turns(seed);
    const Eigen::Matrix3d turn = RandomTurn(turns);
    const PlaneBase turned = Find(turn * points, 0.09);
    // Another coordinate axis may be near enough to be preferred: 40° and somewhat more.
    EXPECT_LE(AngleTo(turned, turn * flat.axes.col(2)), 0.85);
    EXPECT_EQ(turned.overlap, 0);
  }
}

TEST(FindPlaneBaseTest, FindsNoOverlapInASteepSheet) {
  RandomSplines random(4);
  for (const double slope : {0.5, 1.0, 3.0}) {
    SCOPED_TRACE("slope " + std::to_string(slope));
    const Eigen::Matrix3Xd points = Sheet(
        random, 8000, 4, 4, [&](double x, double y) { return slope * std::sin(x) + 0.3 * y; });
    EXPECT_LE(Find(points, 0.05).overlap, 0.01);
  }
}

// A tray: floor, vertical walls and a rim, as deep drawing makes them; equally dense everywhere.
Eigen::Matrix3Xd Tray(RandomSplines& random, int count, double depth) {
  return Points(count, [&] {
    constexpr double kHalf = 1, kRim = 0.4;  // half the width of the floor, width of the rim
    const double floor = 4 * kHalf * kHalf, walls = 8 * kHalf * depth;
    const double rim = 4 * (kHalf + kRim) * (kHalf + kRim) - floor;
    const double area = random.Real(0, floor + walls + rim);
    if (area < floor) return Eigen::Vector3d(random.Real(-1, 1), random.Real(-1, 1), 0);
    if (area < floor + walls) {
      const double along = random.Real(-kHalf, kHalf), side = random.Coin() ? kHalf : -kHalf;
      const double z = random.Real(0, depth);
      return random.Coin() ? Eigen::Vector3d(along, side, z) : Eigen::Vector3d(side, along, z);
    }
    Eigen::Vector3d p;
    do {
      p << random.Real(-kHalf - kRim, kHalf + kRim), random.Real(-kHalf - kRim, kHalf + kRim),
          depth;
    } while (std::max(std::abs(p[0]), std::abs(p[1])) < kHalf);
    return p;
  });
}

// More than 5 % of the normals are level, so that no cone of normals is small; yet only from above
// does the sheet not fold.
TEST(FindPlaneBaseTest, StandsUprightOverVerticalWalls) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    RandomSplines random(seed);
    const double depth = random.Real(0.3, 1);
    SCOPED_TRACE("seed " + std::to_string(seed) + ", depth " + std::to_string(depth));
    const Eigen::Matrix3Xd tray = Tray(random, 8000, depth);
    const PlaneBase base = Find(tray, 0.04);
    EXPECT_EQ(base.axes.col(2), Eigen::Vector3d::UnitZ());
    EXPECT_LE(base.overlap, 0.01);
    EXPECT_GE(base.steepness, 85 * pi / 180);
    // In any pose too: the walls then stand to within a few degrees.
    const Eigen::Matrix3d turn = RandomTurn(random);
    EXPECT_LE(AngleTo(Find(turn * tray, 0.04), turn.col(2)), 6 * pi / 180);
  }
}

TEST(FindPlaneBaseTest, StandsUprightOverSlopesOfTen) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    // Ridges whose flanks have the slope ±10 but at their tops, sampled evenly over the surface.
    const double phase = random.Real(0, 1);
    Eigen::Matrix3Xd points = Points(12000, [&] {
      const double x = random.Real(0, 2.4), y = random.Real(0, 2);
      const double turn = std::sin(x * pi / 0.3 + phase);
      return Eigen::Vector3d(x, y, 10 * 0.3 / pi * std::asin(0.999 * turn));
    });
    const PlaneBase base = Find(points, 0.063);
    EXPECT_EQ(base.axes.col(2), Eigen::Vector3d::UnitZ());
    EXPECT_LE(base.overlap, 0.01);
  }
}

// A bend of more than half a turn folds over every plane: nothing is gained by another one, least
// of all by one that sees the sheet edge-on.
TEST(FindPlaneBaseTest, FindsOverlapInABendOfMoreThanHalfATurn) {
  RandomSplines random(7);
  const Eigen::Matrix3Xd points = Points(20000, [&] {
    const double angle = random.Real(-100, 100) * pi / 180, y = random.Real(0, 2);
    return Eigen::Vector3d(std::sin(angle), y, std::cos(angle));
  });
  const PlaneBase base = Find(points, 0.0187);
  EXPECT_GE(base.overlap, 0.04);
  EXPECT_GE(AngleTo(base, Eigen::Vector3d::UnitY()), 80 * pi / 180);
}

TEST(FindPlaneBaseTest, FindsOverlapInParallelSheets) {
  RandomSplines random(5);
  const Eigen::Matrix3Xd points =
      Sheet(random, 8000, 4, 4, [&](double, double) { return random.Coin() ? 0.0 : 2.0; });
  EXPECT_GE(Find(points, 0.045).overlap, 0.5);
}

TEST(FindPlaneBaseTest, FindsOverlapInAClosedSphere) {
  RandomSplines random(6);
  const Eigen::Matrix3Xd points = Points(8000, [&] {
    const double z = random.Real(-1, 1), angle = random.Real(0, 2 * pi), r = std::sqrt(1 - z * z);
    return Eigen::Vector3d(r * std::cos(angle), r * std::sin(angle), z);
  });
  EXPECT_GE(Find(points, 0.04).overlap, 0.5);
}

TEST(FindPlaneBaseTest, IsTheSameOnAnyNumberOfThreads) {
  RandomSplines random(21);
  for (const double steep : {0.3, 3.0}) {
    // The second one is folded over too.
    Eigen::Matrix3Xd points = Sheet(
        random, 6000, 2, 1, [&](double x, double y) { return steep * std::sin(3 * x + y) / 3; });
    if (steep > 1) points.row(0) += 0.8 * points.row(2);
    points = (RandomTurn(random) * points).eval();
    const NeighbourIndex index(points);
    const PlaneBase one = Find(points, 0.02, 0.01);
    for (const int threads : {1, 2, 5}) {
      SCOPED_TRACE(testing::Message() << steep << " on " << threads);
      ThreadPool pool(threads);
      const PlaneBase base = FindPlaneBase(points, index, 0.02, 0.01, 1, pool);
      EXPECT_EQ(base.axes, one.axes);
      EXPECT_EQ(base.origin, one.origin);
      EXPECT_EQ(base.length_u, one.length_u);
      EXPECT_EQ(base.length_v, one.length_v);
      EXPECT_EQ(base.steepness, one.steepness);
      EXPECT_EQ(base.overlap, one.overlap);
    }
  }
}

TEST(FindPlaneBaseTest, RefusesFewerThanThreePoints) {
  EXPECT_THAT(Refusal(Eigen::Matrix3Xd::Zero(3, 1)), HasSubstr("at least 3"));
  EXPECT_THAT(Refusal(Eigen::Matrix3Xd{{0, 1}, {0, 0}, {0, 0}}), HasSubstr("at least 3"));
}

TEST(FindPlaneBaseTest, RefusesPointsOnALine) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const double scale = random.Logarithmic(1e-6, 1e6);
    const Eigen::Vector3d place = random.Vector(scale), direction = random.Vector(scale);
    const Eigen::Matrix3Xd points = Points(
        random.Integer(3, 200), [&] { return (place + random.Real(-1, 1) * direction).eval(); });
    EXPECT_THAT(Refusal(points), HasSubstr("on a line"));
  }
  EXPECT_THAT(Refusal(Eigen::Vector3d(1, 2, 3).replicate(1, 10)), HasSubstr("on a line"));
  for (const double scale : {1e-101, 1e-150, 1e-300}) {
    EXPECT_THAT(Refusal(scale * Eigen::Matrix3Xd::Identity(3, 3)), HasSubstr("less than 1e-100"));
  }
}

TEST(FindPlaneBaseTest, TakesThreePoints) {
  const Eigen::Matrix3Xd points{{0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  const PlaneBase base = Find(points, 1);
  ExpectHoldsAll(base, points);
  EXPECT_NEAR(AngleTo(base, Eigen::Vector3d::UnitZ()), 0, kHalfDigits);
}

}  // namespace batten::internal::plane_base_test
