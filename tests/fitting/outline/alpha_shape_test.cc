// SPDX-License-Identifier: MIT
#include "fitting/outline/alpha_shape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace batten::internal::alpha_shape_test {

using Directed = std::set<std::pair<std::pair<double, double>, std::pair<double, double>>>;

std::pair<double, double> Key(const Eigen::Vector2d& p) { return {p.x(), p.y()}; }

Eigen::Matrix2Xd RandomPoints(int count, double extent, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> uniform(0, extent);
  Eigen::Matrix2Xd points(2, count);
  for (int k = 0; k < count; ++k) points.col(k) << uniform(engine), uniform(engine);
  return points;
}

// All triangles with empty circumcircles no larger than the radius, by trying all; their sides that
// only one of them has.
Directed BruteForce(const Eigen::Matrix2Xd& points, double radius) {
  Directed sides;
  const Eigen::Index n = points.cols();
  for (Eigen::Index a = 0; a < n; ++a)
    for (Eigen::Index b = a + 1; b < n; ++b)
      for (Eigen::Index c = b + 1; c < n; ++c) {
        const Eigen::Vector2d p = points.col(a), q = points.col(b) - p, r = points.col(c) - p;
        const double twice = 2 * (q.x() * r.y() - q.y() * r.x());
        const Eigen::Vector2d centre =
            Eigen::Vector2d(r.y() * q.squaredNorm() - q.y() * r.squaredNorm(),
                            q.x() * r.squaredNorm() - r.x() * q.squaredNorm()) /
            twice;
        if (centre.norm() > radius) continue;
        bool empty = true;
        for (Eigen::Index d = 0; d < n && empty; ++d)
          empty = d == a || d == b || d == c || (points.col(d) - p - centre).norm() > centre.norm();
        if (!empty) continue;
        const Eigen::Index corners[3] = {a, twice > 0 ? b : c, twice > 0 ? c : b};
        for (int k = 0; k < 3; ++k) {
          const auto from = Key(points.col(corners[k])), to = Key(points.col(corners[(k + 1) % 3]));
          if (sides.erase({to, from}) == 0) sides.insert({from, to});
        }
      }
  return sides;
}

TEST(AlphaShapeTest, IsTheBorderOfAllSmallTriangles) {
  ThreadPool pool(2);
  for (unsigned seed = 1; seed <= 20; ++seed)
    for (const double radius : {0.8, 1.2, 2.5, 40.0}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", radius " + std::to_string(radius));
      const Eigen::Matrix2Xd points = RandomPoints(120, 11, seed);
      Directed found;
      for (const Eigen::Matrix2Xd& loop : AlphaShape(
               points, radius, [](const Eigen::Matrix2Xd&, double) { return true; }, pool))
        for (Eigen::Index i = 0; i < loop.cols(); ++i)
          EXPECT_TRUE(
              found.insert({Key(loop.col(i)), Key(loop.col((i + 1) % loop.cols()))}).second);
      EXPECT_EQ(found, BruteForce(points, radius));
    }
}

// Points far from any empty disc are left out of the triangulation: nothing changes by that.
TEST(AlphaShapeTest, OfManyPointsIsThatOfPointsNearTheBorder) {
  ThreadPool pool(2);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Eigen::Matrix2Xd points = RandomPoints(10000, 100, seed);
    const auto even = [](const Eigen::Matrix2Xd&, double) { return true; };
    const auto loops = AlphaShape(points, 2.5, even, pool);
    Eigen::Matrix2Xd far(2, points.cols() + 1);  // so far that there is no grid
    far << points, Eigen::Vector2d(1e7, 1e7);
    const auto whole = AlphaShape(far, 2.5, even, pool);
    ASSERT_EQ(loops.size(), whole.size());
    for (size_t k = 0; k < loops.size(); ++k) EXPECT_EQ(loops[k], whole[k]);
  }
}

TEST(AlphaShapeTest, FewPointsHaveNone) {
  ThreadPool pool(1);
  const auto even = [](const Eigen::Matrix2Xd&, double) { return true; };
  for (const int count : {0, 1, 2})
    EXPECT_TRUE(AlphaShape(RandomPoints(count, 1, 1), 5, even, pool).empty());
  EXPECT_TRUE(AlphaShape(Eigen::Matrix2Xd::Constant(2, 9, 3.0), 5, even, pool).empty());
  EXPECT_EQ(AlphaShape(RandomPoints(3, 1, 1), 50, even, pool).size(), 1);
}

}  // namespace batten::internal::alpha_shape_test
