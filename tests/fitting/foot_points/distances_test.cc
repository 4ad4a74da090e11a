// SPDX-License-Identifier: MIT
#include "batten/fitting/distances.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "batten/geometry/knot_vectors.h"
#include "batten/geometry/make_curve.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/trim_region.h"
#include "dense_samples.h"
#include "exact_shapes.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::distances_test {

Eigen::Matrix3Xd RandomPoints(RandomSplines& random, Eigen::Index count, double half_side) {
  Eigen::Matrix3Xd points(3, count);
  for (Eigen::Index k = 0; k < count; ++k) points.col(k) = random.Vector(half_side);
  return points;
}

// Points about a sheet over a grid of unit cells.
Eigen::Matrix3Xd PointsAbout(RandomSplines& random, const NurbsSurface& sheet, Eigen::Index count) {
  Eigen::Matrix3Xd points(3, count);
  for (auto p : points.colwise()) {
    p = sheet.At(random.Parameter(sheet.basis_u()), random.Parameter(sheet.basis_v())) +
        random.Vector(0.5);
  }
  return points;
}

TEST(DistancesTest, AreNoLongerThanThoseOfBruteForce) {
  ThreadPool pool(1);
  for (unsigned seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface sheet = random.Sheet(random.Integer(2, 4), random.Integer(2, 4), 0.5);
    const Eigen::Matrix3Xd points = PointsAbout(random, sheet, 50);
    const PointDistances found = DistancesTo(sheet, points, pool);
    DenseSurface dense(sheet, 60);
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      // What brute force finds lies on the surface, though not quite at the least distance.
      EXPECT_LE(std::abs(found.distances[k]),
                dense.Distance(points.col(k), 4) + kIterated * ExtentOf(sheet))
          << "point " << k;
    }
  }
}

// Known places make the search faster and change nothing, right or wrong or not there.
TEST(DistancesTest, NearKnownPlacesAreTheSame) {
  ThreadPool pool(2);
  for (unsigned seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface sheet = random.Sheet(random.Integer(1, 4), random.Integer(1, 4), 0.5);
    const Eigen::Matrix3Xd points = PointsAbout(random, sheet, 600);
    const PointDistances expected = DistancesTo(sheet, points, pool);
    Eigen::Matrix2Xd near = expected.parameters;
    for (Eigen::Index k = 0; k < near.cols(); ++k) {
      if (k % 3 == 0) near.col(k).setConstant(std::numeric_limits<double>::quiet_NaN());
      if (k % 3 == 1) {
        near.col(k) << random.Parameter(sheet.basis_u()), random.Parameter(sheet.basis_v());
      }
    }
    const PointDistances found = DistancesTo(sheet, points, near, pool);
    EXPECT_LE((found.distances.cwiseAbs() - expected.distances.cwiseAbs()).cwiseAbs().maxCoeff(),
              kIterated * ExtentOf(sheet));
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      const double there =
          (sheet.At(found.parameters(0, k), found.parameters(1, k)) - points.col(k)).norm();
      EXPECT_NEAR(there, std::abs(found.distances[k]), kRounding * ExtentOf(sheet));
    }
  }
}

TEST(DistancesTest, AreMeasuredAtTheParametersTheyComeWith) {
  ThreadPool pool(1);
  for (unsigned seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface sheet = random.Sheet(3, 2, 0.5);
    const Eigen::Matrix3Xd points = PointsAbout(random, sheet, 50);
    const PointDistances found = DistancesTo(sheet, points, pool);
    ASSERT_EQ(found.parameters.rows(), 2);
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      const double there =
          (sheet.At(found.parameters(0, k), found.parameters(1, k)) - points.col(k)).norm();
      EXPECT_NEAR(there, std::abs(found.distances[k]), kRounding * ExtentOf(sheet));
    }
  }
}

TEST(DistancesTest, HaveTheSignOfTheSideTheNormalPointsTo) {
  ThreadPool pool(1);
  for (unsigned seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface sheet = random.Sheet(3, 3, 0.3);
    Eigen::Matrix3Xd above(3, 50), below(3, 50);
    constexpr double kOff = 0.01;  // much less than the least radius of curvature
    for (Eigen::Index k = 0; k < 50; ++k) {
      const double u = random.Real(sheet.basis_u().lower(), sheet.basis_u().upper());
      const double v = random.Real(sheet.basis_v().lower(), sheet.basis_v().upper());
      const Eigen::Vector3d normal = sheet.NormalAt(u, v).value();
      above.col(k) = sheet.At(u, v) + kOff * normal;
      below.col(k) = sheet.At(u, v) - kOff * normal;
    }
    const Eigen::VectorXd up = DistancesTo(sheet, above, pool).distances;
    const Eigen::VectorXd down = DistancesTo(sheet, below, pool).distances;
    EXPECT_GT(up.minCoeff(), 0);
    EXPECT_LT(down.maxCoeff(), 0);
    EXPECT_LE(up.maxCoeff(), kOff * (1 + kIterated));
    EXPECT_GE(down.minCoeff(), -kOff * (1 + kIterated));
  }
}

TEST(DistancesTest, OfASphereAreRadiiLessItsOwn) {
  ThreadPool pool(1);
  RandomSplines random(1);
  const Eigen::Matrix3Xd points = RandomPoints(random, 300, 3);
  const Eigen::VectorXd distances = DistancesTo(Sphere(2), points, pool).distances;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    EXPECT_NEAR(distances[k], points.col(k).norm() - 2, kIterated) << "its normals point outward";
  }
}

TEST(DistancesTest, ChangeSignWhenTheSurfaceIsTurnedOver) {
  ThreadPool pool(1);
  RandomSplines random(2);
  const NurbsSurface sheet = random.Sheet(3, 3, 0.3);
  // The same surface with u and v exchanged.
  Eigen::Matrix3Xd net(3, sheet.control_points().cols());
  for (int i = 0; i < sheet.size_u(); ++i) {
    for (int j = 0; j < sheet.size_v(); ++j)
      net.col(j * sheet.size_u() + i) = sheet.control_point(i, j);
  }
  const NurbsSurface turned(sheet.basis_v(), sheet.basis_u(), net);
  const Eigen::Matrix3Xd points = PointsAbout(random, sheet, 100);
  const Eigen::VectorXd a = DistancesTo(sheet, points, pool).distances;
  const Eigen::VectorXd b = DistancesTo(turned, points, pool).distances;
  EXPECT_LE((a + b).cwiseAbs().maxCoeff(), kIterated * ExtentOf(sheet));
}

// A square of the plane z = 0 with a round hole of radius 1/2: the whole distance also beside the
// border, above the plane and below.
TEST(DistancesTest, ToATrimmedSurfaceAreThoseToThePartInsideItsLoops) {
  ThreadPool pool(1);
  const NurbsCurve<2> sides(SplineBasis(1, {0, 0, 1, 2, 3, 4, 4}),
                            Eigen::Matrix<double, 2, 5>{{0, 1, 1, 0, 0}, {0, 0, 1, 1, 0}});
  const NurbsSurface square =
      MakePlane({}, {-1, 1}, {-1, 1})
          .WithTrims(TurnedLoops({sides, MakeArc(Eigen::Vector2d(0.5, 0.5), 0.25)}));
  RandomSplines random(5);
  const Eigen::Matrix3Xd points = RandomPoints(random, 300, 0.7);
  const PointDistances found = DistancesTo(square, points, pool);
  const TrimRegion region(square);
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const double beside = std::max(0.0, 0.5 - points.col(k).head<2>().norm());
    const double height = points(2, k);
    EXPECT_NEAR(found.distances[k], std::copysign(std::hypot(beside, height), height), kIterated);
    EXPECT_TRUE(region.Contains(found.parameters(0, k), found.parameters(1, k)));
  }
}

// Places that are right, wrong, missing, or on another turn of a roll.
TEST(DistancesTest, ToPlacesKnownOrWrongAreTheSame) {
  RandomSplines random(31);
  for (int trial = 0; trial < 6; ++trial) {
    SCOPED_TRACE(trial);
    // A roll whose turns lie `apart` from each other.
    const double apart = 0.05 * (trial + 1);
    const SplineBasis in_u = QuasiUniformKnots(3, 40, 0, 1);
    const SplineBasis in_v = QuasiUniformKnots(2, 5, 0, 1);
    Eigen::Matrix3Xd net(3, 200);
    for (int i = 0; i < 40; ++i) {
      for (int j = 0; j < 5; ++j) {
        const double turn = 0.5 * i, radius = 0.3 + apart * turn / 6.283;
        net.col(5 * i + j) << radius * std::cos(turn), 0.3 * j, radius * std::sin(turn);
      }
    }
    const NurbsSurface surface(in_u, in_v, net);
    constexpr int kPoints = 400;
    Eigen::Matrix3Xd points(3, kPoints);
    Eigen::Matrix2Xd right(2, kPoints), wrong(2, kPoints), some(2, kPoints);
    for (int k = 0; k < kPoints; ++k) {
      right.col(k) << random.Parameter(in_u), random.Parameter(in_v);
      wrong.col(k) << random.Parameter(in_u), random.Parameter(in_v);
      some.col(k) = right.col(k);
      if (k % 3 == 0) some(k % 2, k) = std::numeric_limits<double>::quiet_NaN();
      // Up to farther than half way to the next turn.
      points.col(k) = surface.At(right(0, k), right(1, k)) + random.Vector(0.4 * apart);
    }
    ThreadPool pool(2);
    const PointDistances plain = DistancesTo(surface, points, pool);
    // Both are certified to 1e-11 of the size, which is less than the extent.
    const double near = 2e-11 * ExtentOf(surface);
    for (const Eigen::Matrix2Xd& places : {right, wrong, some}) {
      const PointDistances known = DistancesTo(surface, points, places, pool);
      for (int k = 0; k < kPoints; ++k) {
        EXPECT_NEAR(std::abs(known.distances[k]), std::abs(plain.distances[k]), near) << k;
        const Eigen::Vector3d foot = surface.At(known.parameters(0, k), known.parameters(1, k));
        EXPECT_NEAR((foot - points.col(k)).norm(), std::abs(known.distances[k]), near) << k;
      }
    }
  }
}

TEST(DistancesTest, OfPlacesThatDoNotFitAreRefused) {
  const NurbsSurface surface = RandomSplines(3).Sheet(3, 3, 0.5);
  ThreadPool pool(1);
  EXPECT_THROW(
      DistancesTo(surface, Eigen::Matrix3Xd::Zero(3, 2), Eigen::Matrix2Xd::Zero(2, 3), pool),
      std::invalid_argument);
}

TEST(DistancesTest, FromAStartAreNeverLongerThanThere) {
  ThreadPool pool(1);
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface surface =
        random.Surface(random.Integer(1, 4), random.Integer(1, 4), random.Coin());
    const Eigen::Matrix3Xd points = RandomPoints(random, 50, 2);
    Eigen::Matrix2Xd start(2, 50);
    for (auto uv : start.colwise()) {
      uv << random.Parameter(surface.basis_u()), random.Parameter(surface.basis_v());
    }
    const PointDistances local = DistancesFrom(surface, points, start, pool);
    const PointDistances whole = DistancesTo(surface, points, pool);
    for (Eigen::Index k = 0; k < 50; ++k) {
      const double before = (surface.At(start(0, k), start(1, k)) - points.col(k)).norm();
      EXPECT_LE(std::abs(local.distances[k]), before * (1 + kRounding));
      EXPECT_GE(std::abs(local.distances[k]),
                std::abs(whole.distances[k]) - kIterated * ExtentOf(surface));
    }
  }
}

TEST(DistancesTest, FromTheFootPointsAreTheSameAgain) {
  ThreadPool pool(1);
  for (unsigned seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface sheet = random.Sheet(3, 3, 0.5);
    const Eigen::Matrix3Xd points = PointsAbout(random, sheet, 50);
    const PointDistances once = DistancesTo(sheet, points, pool);
    const PointDistances again = DistancesFrom(sheet, points, once.parameters, pool);
    EXPECT_LE((again.distances - once.distances).cwiseAbs().maxCoeff(),
              kIterated * ExtentOf(sheet));
  }
}

TEST(DistancesTest, OfCurvesAreRadiiLessTheCirclesOwnWithoutASign) {
  ThreadPool pool(1);
  RandomSplines random(3);
  Eigen::Matrix3Xd points = RandomPoints(random, 300, 3);
  points.row(2).setZero();
  const PointDistances found = DistancesTo(Circle(2), points, pool);
  ASSERT_EQ(found.parameters.rows(), 1);
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    EXPECT_NEAR(found.distances[k], std::abs(points.col(k).norm() - 2), kIterated);
  }
}

TEST(DistancesTest, GiveTheSameBitsForEveryNumberOfThreads) {
  RandomSplines random(4);
  const NurbsSurface sheet = random.Sheet(3, 3, 0.5);
  const Eigen::Matrix3Xd points = PointsAbout(random, sheet, 1500);
  ThreadPool one(1), three(3);
  const PointDistances a = DistancesTo(sheet, points, one), b = DistancesTo(sheet, points, three);
  EXPECT_EQ(a.distances, b.distances);
  EXPECT_EQ(a.parameters, b.parameters);
  const Eigen::Matrix2Xd start = a.parameters;
  EXPECT_EQ(DistancesFrom(sheet, points, start, one).distances,
            DistancesFrom(sheet, points, start, three).distances);
}

TEST(DistancesTest, OfNoPointsAreNone) {
  ThreadPool pool(1);
  EXPECT_EQ(DistancesTo(Sphere(1), Eigen::Matrix3Xd(3, 0), pool).distances.size(), 0);
}

}  // namespace batten::internal::distances_test
