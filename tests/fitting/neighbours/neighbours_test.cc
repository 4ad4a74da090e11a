// SPDX-License-Identifier: MIT
#include "batten/fitting/neighbours.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batten/geometry/thread_pool.h"
#include "random_splines.h"

namespace batten::internal::neighbours_test {

// Neighbours are decided in float relative to the middle of the cloud: coordinates are rounded by
// 2^-24 of the extent, so two distances are told apart only beyond a few of those.
constexpr double kFloatDistance = 4 * 0x1p-23;

Eigen::Matrix3Xd RandomPoints(RandomSplines& random, Eigen::Index count) {
  Eigen::Matrix3Xd points(3, count);
  for (Eigen::Index k = 0; k < count; ++k) points.col(k) = random.Vector(1);
  return points;
}

std::vector<double> SortedDistances(const Eigen::Matrix3Xd& points, const Eigen::Vector3d& q) {
  const Eigen::VectorXd distances = (points.colwise() - q).colwise().norm();
  std::vector<double> sorted(distances.begin(), distances.end());
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

// The neighbours found are as near as those of brute force, nearest first, and all different.
void ExpectNearest(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& queries, int k) {
  const NeighbourIndex index(points);
  EXPECT_EQ(index.size(), points.cols());
  const std::vector<int> found = index.Nearest(queries, k);
  const auto per_query = static_cast<int>(std::min<Eigen::Index>(k, points.cols()));
  ASSERT_EQ(std::ssize(found), per_query * queries.cols());
  Eigen::Matrix3Xd all(3, points.cols() + queries.cols());
  all << points, queries;
  const double extent = (all.rowwise().maxCoeff() - all.rowwise().minCoeff()).norm();
  for (Eigen::Index i = 0; i < queries.cols(); ++i) {
    const std::vector<double> expected = SortedDistances(points, queries.col(i));
    const auto row = found.begin() + i * per_query;
    EXPECT_EQ(std::ssize(std::set<int>(row, row + per_query)), per_query);
    for (int j = 0; j < per_query; ++j) {
      ASSERT_GE(row[j], 0);
      ASSERT_LT(row[j], points.cols());
      const double distance = (points.col(row[j]) - queries.col(i)).norm();
      EXPECT_NEAR(distance, expected[j], kFloatDistance * extent) << "neighbour " << j;
    }
  }
}

TEST(NeighbourIndexTest, FindsWhatBruteForceFinds) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const Eigen::Matrix3Xd points = RandomPoints(random, random.Integer(1, 400));
    ExpectNearest(points, RandomPoints(random, 20), random.Integer(1, 30));
    ExpectNearest(points, points, random.Integer(1, 30));
  }
}

TEST(NeighbourIndexTest, FindsThemFarFromTheOriginToo) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const Eigen::Vector3d far = random.Vector(1e7);
    const Eigen::Matrix3Xd points = RandomPoints(random, 300).colwise() + far;
    ExpectNearest(points, RandomPoints(random, 20).colwise() + far, 8);
  }
}

TEST(NeighbourIndexTest, FindsThemFromQueriesOutsideTheCloud) {
  RandomSplines random(1);
  ExpectNearest(RandomPoints(random, 300), 10 * RandomPoints(random, 50), 5);
}

TEST(NeighbourIndexTest, FindsThemInCloudsWithoutVolume) {
  RandomSplines random(2);
  Eigen::Matrix3Xd flat = RandomPoints(random, 300);
  flat.row(2).setZero();
  ExpectNearest(flat, RandomPoints(random, 20), 10);
  flat.row(1).setZero();
  ExpectNearest(flat, RandomPoints(random, 20), 10);
}

TEST(NeighbourIndexTest, DoesNotCareAboutTheUnit) {
  RandomSplines random(3);
  const Eigen::Matrix3Xd points = RandomPoints(random, 300), queries = RandomPoints(random, 50);
  const std::vector<int> expected = NeighbourIndex(points).Nearest(queries, 7);
  for (const double unit : {0x1p-40, 0x1p-20, 0x1p20, 0x1p40}) {
    EXPECT_EQ(NeighbourIndex(unit * points).Nearest(unit * queries, 7), expected)
        << "unit " << unit;
  }
}

TEST(NeighbourIndexTest, GivesAllPointsWhenAskedForMore) {
  RandomSplines random(4);
  for (const int m : {1, 2, 5, 16}) {
    SCOPED_TRACE(std::to_string(m) + " points");
    const Eigen::Matrix3Xd points = RandomPoints(random, m);
    ExpectNearest(points, RandomPoints(random, 5), 40);
  }
}

TEST(NeighbourIndexTest, FindsAPointOfTheCloudItselfFirst) {
  RandomSplines random(5);
  const Eigen::Matrix3Xd points = RandomPoints(random, 500);
  const std::vector<int> first = NeighbourIndex(points).Nearest(points, 1);
  for (int k = 0; k < points.cols(); ++k) EXPECT_EQ(first[k], k);
}

TEST(NeighbourIndexTest, TakesDuplicates) {
  RandomSplines random(6);
  Eigen::Matrix3Xd points(3, 400);
  for (double& x : points.reshaped()) x = random.Integer(0, 2);
  ExpectNearest(points, points.leftCols(40), 60);
  const Eigen::Matrix3Xd same = Eigen::Vector3d(1, 2, 3).replicate(1, 100);
  ExpectNearest(same, same.leftCols(3), 20);
}

TEST(NeighbourIndexTest, PutsLesserIndicesFirstAmongTheEquallyFar) {
  // A lattice of whole numbers, whose squares floats hold exactly.
  constexpr int kSide = 12;
  Eigen::Matrix3Xd points(3, kSide * kSide * kSide);
  for (int k = 0; k < points.cols(); ++k)
    points.col(k) << k % kSide, k / kSide % kSide, k / kSide / kSide;
  const NeighbourIndex index(points);
  for (const int k : {1, 7, 27, 200}) {
    for (const int query : {0, 5, 700, 1000, 1727}) {
      const std::vector<int> found = index.Nearest(points.col(query), k);
      for (size_t j = 1; j < found.size(); ++j) {
        const double before = (points.col(found[j - 1]) - points.col(query)).squaredNorm();
        const double after = (points.col(found[j]) - points.col(query)).squaredNorm();
        EXPECT_TRUE(before < after || (before == after && found[j - 1] < found[j]))
            << "query " << query << ", neighbour " << j;
      }
    }
  }
}

TEST(NeighbourIndexTest, FindsThemAmongManyDuplicatesAndClustersOfAllSizes) {
  RandomSplines random(11);
  Eigen::Matrix3Xd points(3, 6000);
  for (Eigen::Index k = 0; k < points.cols(); ++k)
    points.col(k) = std::exp2(-static_cast<double>(k % 30)) * random.Vector(1);
  points.leftCols(500).colwise() = Eigen::Vector3d(0.5, 0.25, 0.125);
  for (const int k : {1, 25, 480}) ExpectNearest(points, points.leftCols(520).rightCols(40), k);
}

TEST(NeighbourIndexTest, OrdersPointsByBoxesOnAnyNumberOfThreads) {
  RandomSplines random(12);
  for (const Eigen::Index count : {1, 31, 33, 1000, 70000}) {
    SCOPED_TRACE(count);
    const Eigen::Matrix3Xd points = RandomPoints(random, count);
    ThreadPool three(3);
    const NeighbourIndex index(points, three), alone(points);
    const std::vector<int> order(index.order().begin(), index.order().end());
    EXPECT_EQ(std::set<int>(order.begin(), order.end()).size(), static_cast<size_t>(count));
    EXPECT_TRUE(std::equal(order.begin(), order.end(), alone.order().begin()));
    // The two halves of a block are on two sides of a plane across some axis, but for rounding.
    for (size_t block = 64; block <= order.size(); block *= 2) {
      for (size_t start = 0; start + block <= order.size(); start += block) {
        Eigen::Vector3d low, high;
        for (int d = 0; d < 3; ++d) {
          low[d] = -2;
          high[d] = 2;
          for (size_t i = 0; i < block; ++i) {
            const double x = points(d, order[start + i]);
            if (i < block / 2) low[d] = std::max(low[d], x);
            if (i >= block / 2) high[d] = std::min(high[d], x);
          }
        }
        EXPECT_LE((low - high).minCoeff(), kFloatDistance) << "block " << block << " at " << start;
      }
    }
  }
}

TEST(NeighbourIndexTest, AnswersSeveralThreadsAtOnce) {
  RandomSplines random(7);
  const Eigen::Matrix3Xd points = RandomPoints(random, 2000);
  const NeighbourIndex index(points);
  const std::vector<int> expected = index.Nearest(points, 6);
  std::vector<int> found(expected.size());
  ThreadPool pool(3);
  pool.For(points.cols(), 50, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    const std::vector<int> part = index.Nearest(points.middleCols(begin, end - begin), 6);
    std::copy(part.begin(), part.end(), found.begin() + begin * 6);
  });
  EXPECT_EQ(found, expected);
}

TEST(NeighbourIndexTest, MovesWithItsTree) {
  RandomSplines random(8);
  const Eigen::Matrix3Xd points = RandomPoints(random, 50);
  NeighbourIndex index(points);
  const std::vector<int> before = index.Nearest(points, 3);
  const NeighbourIndex moved = std::move(index);
  EXPECT_EQ(moved.Nearest(points, 3), before);
}

TEST(NeighbourIndexTest, RefusesAnEmptyCloud) {
  EXPECT_THROW(NeighbourIndex(Eigen::Matrix3Xd(3, 0)), std::invalid_argument);
}

}  // namespace batten::internal::neighbours_test
