// SPDX-License-Identifier: MIT
#include "fitting/core/point_rank.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "random_splines.h"

namespace batten::internal::point_rank_test {

// `count` points that spread by the lengths along the first axes, turned and shifted.
Eigen::Matrix3Xd Spread(RandomSplines& random,
                        int count,
                        const Eigen::Vector3d& lengths,
                        double shift) {
  Eigen::Matrix3Xd points(3, count);
  for (auto point : points.colwise()) point = lengths.cwiseProduct(random.Vector(1));
  const Eigen::Matrix3d turn = random.Orthogonal();
  points = turn * points;
  points.colwise() += shift * random.Vector(1);
  return points;
}

TEST(PointRankTest, CountsTheDirectionsInWhichPointsSpread) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    for (const double unit : {1e-6, 1.0, 1e6}) {
      for (int rank = 1; rank <= 3; ++rank) {
        Eigen::Vector3d lengths = Eigen::Vector3d::Zero();
        // Spreads of 1e-4 at least are clearly above the limit.
        for (int d = 0; d < rank; ++d)
          lengths[d] = d == 0 ? unit : unit * random.Logarithmic(1e-4, 1);
        EXPECT_EQ(PointRank(Spread(random, 40, lengths, 100 * unit)), rank) << unit;
        // What is far below it counts for nothing.
        Eigen::Vector3d nearly = lengths;
        for (int d = rank; d < 3; ++d) nearly[d] = 1e-8 * unit;
        EXPECT_EQ(PointRank(Spread(random, 40, nearly, 100 * unit)), rank) << unit;
      }
    }
  }
}

TEST(PointRankTest, IsNothingForNoPointsOneOrTheSameOnes) {
  EXPECT_EQ(PointRank(Eigen::MatrixXd(3, 0)), 0);
  EXPECT_EQ(PointRank(Eigen::Vector3d(1, 2, 3)), 0);
  EXPECT_EQ(PointRank(Eigen::MatrixXd::Constant(3, 8, 0.5)), 0);
}

TEST(PointRankTest, IsAtMostTheDimensionAndOneLessThanThePoints) {
  RandomSplines random(1);
  for (int dimension = 1; dimension <= 3; ++dimension) {
    for (int count = 2; count <= 6; ++count) {
      Eigen::MatrixXd points(dimension, count);
      for (double& x : points.reshaped()) x = random.Real(-1, 1);
      EXPECT_EQ(PointRank(points), std::min(dimension, count - 1));
    }
  }
}

}  // namespace batten::internal::point_rank_test
