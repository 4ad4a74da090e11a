// SPDX-License-Identifier: MIT
#include "fitting/neighbours/normals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "random_splines.h"

namespace batten::internal::normals_test {

// PCL works in float: covariances carry 24 bits, directions a good half of them.
constexpr double kFloatDirection = 1e-3;

Eigen::Matrix3Xd RandomPoints(RandomSplines& random, Eigen::Index count) {
  Eigen::Matrix3Xd points(3, count);
  for (Eigen::Index k = 0; k < count; ++k) points.col(k) = random.Vector(1);
  return points;
}

Eigen::Matrix3Xd Normals(const Eigen::Matrix3Xd& points, int k) {
  return EstimateNormals(NeighbourIndex(points), points, points, k);
}

void ExpectUnitOrZero(const Eigen::Matrix3Xd& normals) {
  ASSERT_TRUE(normals.allFinite());
  for (const auto& normal : normals.colwise()) {
    const double length = normal.norm();
    EXPECT_TRUE(length == 0 || std::abs(length - 1) < kFloatDirection) << "length " << length;
  }
}

TEST(EstimateNormalsTest, AreThoseOfAPlaneInAnyPose) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    Eigen::Matrix3Xd points = RandomPoints(random, 300);
    points.row(2).setZero();
    const Eigen::Matrix3d turn = random.Orthogonal();
    points = (random.Logarithmic(1e-6, 1e6) * turn * points).eval();
    const Eigen::Matrix3Xd normals = Normals(points, random.Integer(6, 30));
    for (const auto& normal : normals.colwise()) {
      EXPECT_NEAR(std::abs(normal.dot(turn.col(2))), 1, kFloatDirection);
    }
  }
}

TEST(EstimateNormalsTest, AreTheSameFarFromTheOrigin) {
  RandomSplines random(1);
  Eigen::Matrix3Xd points = RandomPoints(random, 300);
  points.row(2) *= 0;
  points.colwise() += Eigen::Vector3d(5e5, 5.4e6, 300);
  const Eigen::Matrix3Xd normals = Normals(points, 15);
  for (const auto& normal : normals.colwise()) {
    EXPECT_NEAR(std::abs(normal.z()), 1, kFloatDirection);
  }
}

TEST(EstimateNormalsTest, PointAtTheCentreOfASphere) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    Eigen::Matrix3Xd points(3, 4000);
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      Eigen::Vector3d p;
      do {
        p = random.Vector(1);
      } while (p.norm() > 1 || p.norm() < 0.1);
      points.col(k) = p.normalized();
    }
    const Eigen::Matrix3Xd normals = Normals(points, 30);
    // Thirty of 4000 points lie within 0.17: a lopsided neighbourhood leans by a good part of that.
    EXPECT_GE(normals.cwiseProduct(points).colwise().sum().cwiseAbs().minCoeff(), std::cos(0.1));
  }
}

TEST(EstimateNormalsTest, AreAskedForAnywhereNearThePoints) {
  RandomSplines random(2);
  Eigen::Matrix3Xd points = RandomPoints(random, 300);
  points.row(2).setZero();
  const Eigen::Matrix3Xd queries = RandomPoints(random, 20);
  const Eigen::Matrix3Xd normals = EstimateNormals(NeighbourIndex(points), points, queries, 12);
  ASSERT_EQ(normals.cols(), queries.cols());
  for (const auto& normal : normals.colwise())
    EXPECT_NEAR(std::abs(normal.z()), 1, kFloatDirection);
}

TEST(EstimateNormalsTest, AreZeroOrUnitVectorsWhereNeighboursLieOnALine) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const Eigen::Vector3d direction =
        seed == 0 ? Eigen::Vector3d::UnitX().eval() : random.Vector(1);
    Eigen::Matrix3Xd points(3, 50);
    for (Eigen::Index k = 0; k < 50; ++k) points.col(k) = random.Real(-1, 1) * direction;
    ExpectUnitOrZero(Normals(points, 10));
  }
}

TEST(EstimateNormalsTest, AreZeroWhereAllNeighboursAreOnePoint) {
  const Eigen::Matrix3Xd points = Eigen::Vector3d(1, 2, 3).replicate(1, 20);
  EXPECT_TRUE(Normals(points, 10).isZero(0));
}

TEST(EstimateNormalsTest, AreZeroWhereThereAreTooFewNeighbours) {
  const Eigen::Matrix3Xd points{{0, 1}, {0, 0}, {0, 0}};
  EXPECT_TRUE(Normals(points, 10).isZero(0));
  EXPECT_TRUE(Normals(points.leftCols(1), 10).isZero(0));
}

TEST(EstimateNormalsTest, OfThreePointsIsThatOfTheirPlane) {
  const Eigen::Matrix3Xd points{{0, 1, 0}, {0, 0, 1}, {0, 0, 0}};
  const Eigen::Matrix3Xd normals = Normals(points, 3);
  for (const auto& normal : normals.colwise())
    EXPECT_NEAR(std::abs(normal.z()), 1, kFloatDirection);
}

}  // namespace batten::internal::normals_test
