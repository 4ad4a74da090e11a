// SPDX-License-Identifier: MIT
// Surfaces by where they touch: distances, their derivatives, and the minimum from near starts.
#include "fitting/primitives/surface_minimum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <variant>
#include <vector>

#include "fitting/primitives/surface_distance.h"
#include "measured_shapes.h"
#include "tolerances.h"

namespace batten::internal::surface_minimum_test {

FittedSurface RandomSurface(SurfaceKind kind, RandomSplines& random) {
  FittedSurface shape;
  shape.kind = kind;
  const Eigen::Matrix3d frame = random.Orthogonal();
  shape.point = random.Vector(0.5);
  shape.normal = frame.col(0);
  shape.along = frame.col(1);
  if (kind == SurfaceKind::kSphere || kind == SurfaceKind::kTorus) {
    shape.curvature = random.Real(-3, 3);
  }
  if (kind >= SurfaceKind::kCylinder) shape.axis_curvature = random.Real(-3, 3);
  if (kind >= SurfaceKind::kCone) shape.slope = random.Real(-3, 3);
  return shape;
}

TEST(SurfaceMinimumTest, RowsAreTheDerivativesOfTheDistance) {
  RandomSplines random(1);
  for (int trial = 0; trial < 500; ++trial) {
    SCOPED_TRACE(trial);
    const FittedSurface shape = RandomSurface(kSurfaceKinds[trial % 5], random);
    const Eigen::Vector3d p = random.Vector(1);
    WithKind(shape.kind, [&]<SurfaceKind kKind>() {
      using Distance = SurfaceDistance<kKind>;
      typename Distance::Row row, other;
      const double distance = Distance(shape)(p, row);
      EXPECT_EQ(distance, shape.Distance(p));
      for (int i = 0; i < Distance::kFreedoms; ++i) {
        constexpr double kStep = 1e-6;
        const Eigen::Matrix<double, 7, 1> step = kStep * Eigen::Matrix<double, 7, 1>::Unit(i);
        const double high = Distance(Moved(shape, step))(p, other);
        const double low = Distance(Moved(shape, -step))(p, other);
        // Rows jump at focal points.
        if (std::abs(high + low - 2 * distance) > 1e-8) continue;
        EXPECT_NEAR((high - low) / (2 * kStep), row[i], 1e-6 * (1 + row.norm())) << "freedom " << i;
      }
    });
  }
}

TEST(SurfaceMinimumTest, DistancesAgreeWithThoseFromCentres) {
  RandomSplines random(2);
  for (int trial = 0; trial < 300; ++trial) {
    SCOPED_TRACE(trial);
    const FittedSurface shape = RandomSurface(kSurfaceKinds[trial % 5], random);
    const SurfaceShape known = shape.Shape(1, Eigen::Vector3d::Zero());
    const Eigen::Vector3d p = random.Vector(1);
    const double expected = DistanceTo(known, p);
    // Of a spindle a fitted surface has one arc.
    const auto* torus = std::get_if<TorusShape>(&known);
    if (torus != nullptr && torus->minor_radius > torus->major_radius) continue;
    EXPECT_NEAR(std::abs(shape.Distance(p)), expected, 1e-10 * (1 + expected));
  }
}

TEST(SurfaceMinimumTest, TheSameShapeTouchesAnywhere) {
  RandomSplines random(3);
  for (int trial = 0; trial < 300; ++trial) {
    SCOPED_TRACE(trial);
    const FittedSurface shape = RandomSurface(kSurfaceKinds[trial % 5], random);
    const FittedSurface moved = shape.TouchingNear(shape.point + random.Vector(0.1));
    EXPECT_NEAR(moved.normal.dot(moved.along), 0, kRounding);
    for (int k = 0; k < 10; ++k) {
      const Eigen::Vector3d p = shape.point + random.Vector(0.3);
      EXPECT_NEAR(moved.Distance(p), shape.Distance(p), kIterated);
    }
  }
}

// From starts some way off, exact points are met to rounding, wherever the piece lies.
TEST(SurfaceMinimumTest, MeetsExactPoints) {
  RandomSplines random(4);
  ThreadPool pool(2);
  for (int trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE(trial);
    const SurfaceKind kind = kSurfaceKinds[trial % 5];
    const MeasuredShape shape = RandomShape(kind, random);
    ShapeData data{RandomPoints(shape, RandomPiece(shape, random), 300, random), {}};
    data.weights = Eigen::VectorXd::Ones(300);
    FittedSurface start = TouchingNear(shape.shape, data.points.col(0));
    Eigen::Matrix<double, 7, 1> off;
    for (double& value : off) value = random.Real(-0.02, 0.02);
    start = Moved(start, off);
    const SurfaceMinimum found = Minimised(start, data, {}, 100, pool);
    EXPECT_TRUE(found.converged);
    EXPECT_LE(SurfaceDistances(found.shape, data.points, pool).lpNorm<Eigen::Infinity>(),
              kRounding);
  }
}

}  // namespace batten::internal::surface_minimum_test
