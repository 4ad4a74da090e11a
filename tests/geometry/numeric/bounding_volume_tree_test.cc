// SPDX-License-Identifier: MIT
#include "geometry/numeric/bounding_volume_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "geometry/numeric/point_kd_tree.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::bounding_volume_tree_test {

TEST(BoundingVolumeTreeTest, FindsTheBoxesWithinADistanceAndNoOthers) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    std::vector<Eigen::AlignedBox3d> boxes;
    const int count = seed % 4 == 0 ? random.Integer(0, 10) : random.Integer(1, 2000);
    for (int k = 0; k < count; ++k) {
      // Some are points, and many fall together.
      const Eigen::Vector3d at = seed % 3 == 0 ? Eigen::Vector3d::Zero() : random.Vector(1);
      const Eigen::Vector3d half =
          random.Coin() ? random.Vector(0.2).cwiseAbs().eval() : Eigen::Vector3d::Zero().eval();
      boxes.emplace_back(at - half, at + half);
    }
    const BoundingVolumeTree tree(boxes);
    for (int trial = 0; trial < 20; ++trial) {
      const Eigen::Vector3d q = random.Vector(2);
      const double squared = random.Real(0, 3);
      std::vector<BoundingVolumeTree::Near> found;
      tree.Within(q.data(), squared, found);
      std::vector<int> got, expected;
      for (const BoundingVolumeTree::Near& near : found) {
        got.push_back(near.box);
        EXPECT_NEAR(near.squared_distance, boxes[near.box].squaredExteriorDistance(q), kRounding);
      }
      for (int k = 0; k < count; ++k) {
        if (boxes[k].squaredExteriorDistance(q) <= squared) expected.push_back(k);
      }
      std::sort(got.begin(), got.end());
      EXPECT_EQ(got, expected);
    }
  }
}

TEST(PointKdTreeTest, FindsANearestPoint) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    Eigen::Matrix3Xd points(3, random.Integer(1, 3000));
    // Some fall together, some lie in a plane.
    for (auto point : points.colwise()) {
      point = seed % 3 == 0 ? Eigen::Vector3d(random.Vector(3).array().round()) : random.Vector(3);
    }
    if (seed % 4 == 0) points.row(1).setZero();
    const PointKdTree tree(points);
    for (int trial = 0; trial < 50; ++trial) {
      const Eigen::Vector3d q = random.Vector(5);
      const int nearest = tree.Nearest(q.data());
      const double squared = (points.colwise() - q).colwise().squaredNorm().minCoeff();
      EXPECT_NEAR((points.col(nearest) - q).squaredNorm(), squared, kRounding * squared);
    }
  }
}

TEST(PointKdTreeTest, VisitsEveryPointOfABallOnce) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    Eigen::Matrix3Xd points(3, random.Integer(0, 2000));
    // Whole coordinates fall together and lie on the ball.
    for (auto point : points.colwise()) {
      point = seed % 2 == 0 ? Eigen::Vector3d(random.Vector(4).array().round()) : random.Vector(3);
    }
    const PointKdTree tree(points);
    for (int trial = 0; trial < 50; ++trial) {
      Eigen::Vector3d centre = random.Vector(4);
      double radius = random.Vector(2).norm();
      if (seed % 2 == 0) {
        centre = centre.array().round();
        radius = std::round(radius);
      }
      std::vector<int> got, expected;
      tree.ForBall(centre, radius, [&](int k, double squared) {
        got.push_back(k);
        EXPECT_NEAR(squared, (points.col(k) - centre).squaredNorm(), kRounding * squared);
      });
      for (int k = 0; k < points.cols(); ++k) {
        const double dx = points(0, k) - centre[0], dy = points(1, k) - centre[1],
                     dz = points(2, k) - centre[2];
        if (dx * dx + dy * dy + dz * dz <= radius * radius) expected.push_back(k);
      }
      std::sort(got.begin(), got.end());
      EXPECT_EQ(got, expected);
    }
  }
}

}  // namespace batten::internal::bounding_volume_tree_test
