// SPDX-License-Identifier: MIT
#include "fitting/cloud/cloud_outliers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "batten/fitting/cloud_statistics.h"
#include "angles.h"

namespace batten::internal::cloud_outliers_test {

using Shape = std::function<Eigen::Vector3d(double, double)>;
Eigen::Vector3d Shell(double u, double v) {  // bent by 200 degrees
  const double angle = (-100 + 200 * u) * kPi / 180;
  const double r = 1 + 0.08 * std::sin(3 * kPi * u) * std::cos(2 * kPi * v);
  return {r * std::sin(angle), 2 * v + 0.1 * std::sin(2 * kPi * u), r * std::cos(angle)};
}
Eigen::Vector3d Roll(double u, double v) {  // one and a half turns
  const double angle = 3 * kPi * u, r = 0.3 + 0.2 * u;
  return {r * std::cos(angle), v, r * std::sin(angle)};
}
Eigen::Vector3d Wave(double u, double v) {
  return {u, v, 0.05 * std::sin(12 * u) * std::cos(9 * v)};
}
Eigen::Vector3d Crease(double u, double v) {  // two faces at a right angle
  return {u - 0.5, v, -std::abs(u - 0.5)};
}
Eigen::Vector3d Step(double u, double v) {  // ten spacings high
  if (u < 0.45) return {u, v, 0};
  return u < 0.55 ? Eigen::Vector3d(0.45, v, u - 0.45) : Eigen::Vector3d(u - 0.1, v, 0.1);
}

// Points of a shape, `density` times as many at one end of u as at the other.
Eigen::Matrix3Xd Sample(
    const Shape& shape, Eigen::Index count, double sigma, double density, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> place;
  std::normal_distribution<double> normal(0, sigma > 0 ? sigma : 1);
  Eigen::Matrix3Xd points(3, count);
  for (auto p : points.colwise()) {
    const double t = place(engine);
    const double u = density > 1 ? std::log1p(t * (density - 1)) / std::log(density) : t;
    p = shape(u, place(engine));
    if (sigma > 0) p += Eigen::Vector3d(normal(engine), normal(engine), normal(engine));
  }
  return points;
}

// The same with points uniform in its box behind them.
Eigen::Matrix3Xd WithOutliers(const Eigen::Matrix3Xd& good, Eigen::Index count, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> place;
  const Eigen::Array3d low = good.rowwise().minCoeff(), high = good.rowwise().maxCoeff();
  Eigen::Matrix3Xd points(3, good.cols() + count);
  points.leftCols(good.cols()) = good;
  for (auto p : points.rightCols(count).colwise()) {
    p = (low + Eigen::Array3d(place(engine), place(engine), place(engine)) * (high - low)).matrix();
  }
  return points;
}

double DistanceFromShape(const NeighbourIndex& index,
                         const Eigen::Matrix3Xd& dense,
                         const Eigen::Vector3d& p) {
  return (dense.col(index.Nearest(p, 1)[0]) - p).norm();
}

PointMask Find(const Eigen::Matrix3Xd& points, double* spacing = nullptr) {
  ThreadPool pool(2);
  const CloudStatistics measured = MeasureCloud(points, NeighbourIndex(points), {}, pool);
  if (spacing != nullptr) *spacing = measured.spacing;
  return measured.outliers;
}

TEST(FindOutliersTest, FlagsPointsInABentSheetsBoxAndKeepsTheSheet) {
  constexpr Eigen::Index kGood = 10000;
  for (const auto& [name, shape] : std::vector<std::pair<std::string, Shape>>{
           {"shell", Shell}, {"roll", Roll}, {"wave", Wave}}) {
    const Eigen::Matrix3Xd dense = Sample(shape, 400000, 0, 1, 99);
    const NeighbourIndex index(dense);
    for (const double share : {0.01, 0.05, 0.2}) {
      SCOPED_TRACE(name + ", share " + std::to_string(share));
      const auto bad = static_cast<Eigen::Index>(share * kGood);
      const Eigen::Matrix3Xd points = WithOutliers(Sample(shape, kGood, 1e-3, 1, 1), bad, 2);
      double spacing;
      const PointMask outliers = Find(points, &spacing);
      EXPECT_LE(outliers.head(kGood).count(), kGood / 1000);
      // More than a spacing off, which a tenth of that is the noise of.
      Eigen::Index off = 0, flagged = 0;
      for (Eigen::Index k = kGood; k < points.cols(); ++k) {
        if (DistanceFromShape(index, dense, points.col(k)) < spacing) continue;
        ++off;
        if (outliers[k]) ++flagged;
      }
      EXPECT_GE(static_cast<double>(flagged), 0.97 * static_cast<double>(off)) << "of " << off;
    }
  }
}

TEST(FindOutliersTest, KeepsTheSparseEndOfACleanSheet) {
  for (const auto& [name, shape] :
       std::vector<std::pair<std::string, Shape>>{{"shell", Shell}, {"wave", Wave}}) {
    for (const double density : {10.0, 100.0}) {
      for (const double sigma : {0.0, 1e-3, 1e-2}) {
        SCOPED_TRACE(name + ", density " + std::to_string(density) + ", sigma " +
                     std::to_string(sigma));
        EXPECT_LE(Find(Sample(shape, 20000, sigma, density, 5)).count(), 20);
      }
    }
  }
}

TEST(FindOutliersTest, KeepsCreasesAndSteps) {
  for (const auto& [name, shape] :
       std::vector<std::pair<std::string, Shape>>{{"crease", Crease}, {"step", Step}}) {
    for (const double sigma : {0.0, 1e-3, 1e-2}) {
      for (unsigned seed = 5; seed < 7; ++seed) {
        SCOPED_TRACE(name + ", sigma " + std::to_string(sigma) + ", seed " + std::to_string(seed));
        EXPECT_LE(Find(Sample(shape, 20000, sigma, 1, seed)).count(), 20);
      }
    }
  }
}

TEST(FindOutliersTest, TakesLinesAndClumps) {
  // Nothing is promised but an answer.
  Eigen::Matrix3Xd line = Eigen::Matrix3Xd::Zero(3, 500);
  for (Eigen::Index k = 0; k < 500; ++k) line(0, k) = static_cast<double>(k);
  EXPECT_EQ(Find(line).size(), 500);
  const Eigen::Matrix3Xd sheet = Sample(Wave, 500, 1e-3, 1, 1);
  Eigen::Matrix3Xd clumps(3, 1000);
  clumps << sheet, 1e-7 * sheet;
  EXPECT_EQ(Find(clumps).size(), 1000);
}

}  // namespace batten::internal::cloud_outliers_test
