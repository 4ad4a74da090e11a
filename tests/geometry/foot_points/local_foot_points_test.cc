// SPDX-License-Identifier: MIT
#include "batten/geometry/local_foot_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "batten/geometry/make_surface.h"
#include "exact_shapes.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::local_foot_points_test {

struct Case {
  Eigen::Matrix3Xd points;
  Eigen::Matrix2Xd starts;
};

// Points near a surface, some on it and some at its edge, with starts a little off.
Case PointsNear(RandomSplines& random, const NurbsSurface& surface, Eigen::Index count) {
  constexpr double kOff = 0.05;
  Case made{Eigen::Matrix3Xd(3, count), Eigen::Matrix2Xd(2, count)};
  const SplineBasis &bu = surface.basis_u(), &bv = surface.basis_v();
  for (Eigen::Index k = 0; k < count; ++k) {
    const double u = k % 9 == 0 ? bu.lower() : random.Parameter(bu);
    const double v = k % 7 == 0 ? bv.upper() : random.Parameter(bv);
    made.points.col(k) = surface.At(u, v);
    if (k % 5 != 0) made.points.col(k) += random.Vector(kOff);
    made.starts.col(k) << u + random.Real(-kOff, kOff) * (bu.upper() - bu.lower()),
        v + random.Real(-kOff, kOff) * (bv.upper() - bv.lower());
  }
  return made;
}

double SignedDistance(const NurbsSurface& surface,
                      const SurfaceFoot& foot,
                      const Eigen::Vector3d& q) {
  const auto normal = surface.NormalAt(foot.u, foot.v);
  return normal && normal->dot(q - foot.point) < 0 ? -foot.distance : foot.distance;
}

// Which of several minima a descent comes to hangs on the last digit only near a divide: hardly
// ever so near the surface.
void ExpectThoseOfLocalFootPoint(const NurbsSurface& surface, const Case& given) {
  ThreadPool pool(1);
  const LocalFootPointsKernel feet =
      LocalFootPoints(SurfaceEvaluator(surface), given.points, given.starts, pool);
  int others = 0;
  for (Eigen::Index k = 0; k < given.points.cols(); ++k) {
    const Eigen::Vector3d q = given.points.col(k);
    const SurfaceFoot foot = LocalFootPoint(surface, q, given.starts(0, k), given.starts(1, k));
    const double there = (surface.At(feet.parameters(0, k), feet.parameters(1, k)) - q).norm();
    EXPECT_NEAR(there, std::abs(feet.distances[k]), kRounding * ExtentOf(surface));
    const double expected = SignedDistance(surface, foot, q);
    const double off = std::abs(std::abs(feet.distances[k]) - foot.distance);
    if (off > kIterated * ExtentOf(surface)) {
      ++others;
    } else if (foot.distance > kIterated * ExtentOf(surface)) {
      EXPECT_EQ(feet.distances[k] < 0, expected < 0) << "point " << k;
    }
  }
  EXPECT_LE(others, 2);
}

TEST(LocalFootPointsTest, AreThoseOfOnePointAtATimeOnRandomSheets) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface sheet = random.Sheet(random.Integer(1, 5), random.Integer(1, 5), 0.3);
    ExpectThoseOfLocalFootPoint(sheet, PointsNear(random, sheet, 60));
  }
}

TEST(LocalFootPointsTest, AreThoseOfOnePointAtATimeOnRandomRationalSurfaces) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface surface =
        random.Surface(random.Integer(1, 4), random.Integer(1, 4), random.Coin());
    ExpectThoseOfLocalFootPoint(surface, PointsNear(random, surface, 60));
  }
}

TEST(LocalFootPointsTest, AreThoseOfOnePointAtATimeOnClosedShapesWithPoles) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    for (const NurbsSurface& shape : {Sphere(2), Torus(3, 1), Cylinder(1, 2)}) {
      ExpectThoseOfLocalFootPoint(shape, PointsNear(random, shape, 60));
    }
  }
}

TEST(LocalFootPointsTest, KeepTheirDigitsFarFromTheOrigin) {
  const Eigen::Vector3d far(5e6, -4e6, 3e6);
  ThreadPool pool(1);
  for (unsigned seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface sheet = random.Sheet(3, 3, 0.3);
    const Case given = PointsNear(random, sheet, 100);
    const LocalFootPointsKernel near =
        LocalFootPoints(SurfaceEvaluator(sheet), given.points, given.starts, pool);
    const LocalFootPointsKernel moved = LocalFootPoints(
        SurfaceEvaluator(sheet.Translated(far)), given.points.colwise() + far, given.starts, pool);
    // Coordinates of 5e6 are rounded to 1e-9.
    EXPECT_LE((near.distances.cwiseAbs() - moved.distances.cwiseAbs()).cwiseAbs().maxCoeff(), 1e-8);
  }
}

// A sheet flat but for what is small is met at right angles: x and y are the parameters.
TEST(LocalFootPointsTest, OfAPlaneAreItsProjectionsWithinItsSides) {
  ThreadPool pool(1);
  const NurbsSurface plane = MakePlane({}, {-1, 1}, {-1, 1});
  RandomSplines random(3);
  Eigen::Matrix3Xd points(3, 500);
  for (auto p : points.colwise()) p = random.Vector(2);
  const Eigen::Matrix2Xd starts = Eigen::Matrix2Xd::Constant(2, points.cols(), 0.5);
  const LocalFootPointsKernel feet = LocalFootPoints(SurfaceEvaluator(plane), points, starts, pool);
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const Eigen::Vector3d q = points.col(k);
    const Eigen::Vector3d foot(std::clamp(q[0], -1.0, 1.0), std::clamp(q[1], -1.0, 1.0), 0);
    EXPECT_NEAR(feet.distances[k], std::copysign((q - foot).norm(), q[2]), kIterated);
  }
}

TEST(LocalFootPointsTest, OfAPointDoNotDependOnOtherPointsNorOnThreads) {
  RandomSplines random(4);
  const NurbsSurface sheet = random.Sheet(3, 3, 0.5);
  const SurfaceEvaluator evaluator(sheet);
  const Case given = PointsNear(random, sheet, 9000);
  ThreadPool one(1), three(3);
  const LocalFootPointsKernel all = LocalFootPoints(evaluator, given.points, given.starts, one);
  const LocalFootPointsKernel again = LocalFootPoints(evaluator, given.points, given.starts, three);
  EXPECT_EQ(all.distances, again.distances);
  EXPECT_EQ(all.parameters, again.parameters);
  for (Eigen::Index k = 0; k < given.points.cols(); k += 97) {
    const LocalFootPointsKernel alone =
        LocalFootPoints(evaluator, given.points.col(k), given.starts.col(k), one);
    EXPECT_EQ(alone.distances[0], all.distances[k]);
    EXPECT_EQ(alone.parameters.col(0), all.parameters.col(k));
  }
}

TEST(LocalFootPointsTest, AskForOneStartAPoint) {
  ThreadPool pool(1);
  EXPECT_THROW(LocalFootPoints(SurfaceEvaluator(Sphere(1)),
                               Eigen::Matrix3Xd::Zero(3, 2),
                               Eigen::Matrix2Xd::Zero(2, 1),
                               pool),
               std::invalid_argument);
}

}  // namespace batten::internal::local_foot_points_test
