// SPDX-License-Identifier: MIT
// Planes, spheres, cylinders, cones and tori found in points from no start at all.
#include "fitting/primitives/shape_fitter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "cases.h"
#include "measured_shapes.h"
#include "tolerances.h"

namespace batten::internal::shape_fitter_test {

// The rms of the points' distances from a shape.
double Rms(const SurfaceShape& shape, const Eigen::Matrix3Xd& points) {
  double squares = 0;
  for (const auto& p : points.colwise()) squares += std::pow(DistanceTo(shape, p), 2);
  return std::sqrt(squares / static_cast<double>(points.cols()));
}

// The least-squares shape is nearer to the points than the one they were measured on.
TEST(ShapeFitterTest, FindsWholeShapesAndPieces) {
  RandomSplines random(1);
  ThreadPool pool(2);
  for (int trial = 0; trial < 60; ++trial) {
    SCOPED_TRACE(trial);
    const SurfaceKind kind = kSurfaceKinds[trial % 5];
    const MeasuredShape truth = RandomShape(kind, random);
    const double sigma = random.Logarithmic(1e-6, 3e-3);
    const Eigen::Matrix3Xd points =
        RandomPoints(truth, RandomPiece(truth, random), random.Integer(200, 1500), random, sigma);
    const ShapeFit fit = ShapeFitter(points, {}, {}, pool).Fit(kind);
    EXPECT_LE(Rms(fit.shape, points), 1.0001 * Rms(truth.shape, points));
    EXPECT_LE(fit.outliers.count(), 1);
    EXPECT_NEAR(fit.distances.cwiseAbs()[7], DistanceTo(fit.shape, points.col(7)), kIterated);
  }
}

TEST(ShapeFitterTest, SetsOutliersAside) {
  RandomSplines random(2);
  ThreadPool pool(2);
  constexpr int kCount = 1500;
  for (int trial = 0; trial < 30; ++trial) {
    SCOPED_TRACE(trial);
    const SurfaceKind kind = kSurfaceKinds[trial % 5];
    const MeasuredShape truth = RandomShape(kind, random);
    Eigen::Matrix3Xd points =
        RandomPoints(truth, PieceOf(truth, 0.5, random), kCount, random, 1e-3);
    const Eigen::Vector3d low = points.rowwise().minCoeff(), high = points.rowwise().maxCoeff();
    const Eigen::Index bad = kCount / 5;
    for (auto p : points.leftCols(bad).colwise()) {
      for (int i = 0; i < 3; ++i) p[i] = random.Real(low[i], high[i]);
    }
    const ShapeFit fit = ShapeFitter(points, {}, {}, pool).Fit(kind);
    const auto good = points.rightCols(kCount - bad);
    EXPECT_LE(Rms(fit.shape, good), 1.02 * Rms(truth.shape, good));
    EXPECT_NEAR(fit.sigma, 1e-3, 1e-4);
  }
}

// Far away, in other units, with another number of threads.
TEST(ShapeFitterTest, UnitsAndThreadsDoNotMatter) {
  RandomSplines random(3);
  ThreadPool one(1), three(3);
  for (int trial = 0; trial < Cases(10); ++trial) {
    SCOPED_TRACE(trial);
    const SurfaceKind kind = kSurfaceKinds[trial % 5];
    const MeasuredShape truth = RandomShape(kind, random, 0);
    const Eigen::Matrix3Xd points =
        RandomPoints(truth, RandomPiece(truth, random), 20000, random, 1e-3);
    const ShapeFit fit = ShapeFitter(points, {}, {}, one).Fit(kind);
    const ShapeFit same = ShapeFitter(points, {}, {}, three).Fit(kind);
    EXPECT_EQ(fit.distances, same.distances);
    const Eigen::Matrix3Xd large = 1e6 * points;
    const ShapeFit other = ShapeFitter(large, {}, {}, one).Fit(kind);
    EXPECT_LE((other.distances / 1e6 - fit.distances).lpNorm<Eigen::Infinity>(), kIterated);
  }
}

TEST(ShapeFitterTest, RefusesFewerPointsThanFreedoms) {
  RandomSplines random(4);
  ThreadPool pool(1);
  for (const SurfaceKind kind : kSurfaceKinds) {
    const MeasuredShape truth = RandomShape(kind, random);
    const Eigen::Matrix3Xd points =
        RandomPoints(truth, PieceOf(truth, 1, random), FreedomsOf(kind), random);
    EXPECT_NO_THROW(ShapeFitter(points, {}, {}, pool).Fit(kind));
    const Eigen::Matrix3Xd fewer = points.leftCols(FreedomsOf(kind) - 1);
    EXPECT_THROW(ShapeFitter(fewer, {}, {}, pool).Fit(kind), std::invalid_argument);
  }
}

}  // namespace batten::internal::shape_fitter_test
