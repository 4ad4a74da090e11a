// SPDX-License-Identifier: MIT
#include "geometry/mesh/half_edges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "geometry/mesh/point_numbers.h"

namespace batten::internal::half_edges_test {

constexpr unsigned kSeed = 20261129;

Eigen::Matrix3Xi RandomTriangles(int count, int vertices) {
  std::mt19937 random(kSeed);
  Eigen::Matrix3Xi triangles(3, count);
  for (int t = 0; t < count; ++t) {
    std::set<int> corners;
    while (corners.size() < 3) corners.insert(static_cast<int>(random() % unsigned(vertices)));
    std::array<int, 3> order;
    std::copy(corners.begin(), corners.end(), order.begin());
    std::shuffle(order.begin(), order.end(), random);
    triangles.col(t) << order[0], order[1], order[2];
  }
  return triangles;
}

// Against a map of all edges.
TEST(HalfEdgesTest, TwinsAreTheOnlyTwoBetweenTheirVertices) {
  for (const int vertices : {4, 9, 60}) {
    SCOPED_TRACE(vertices);
    const Eigen::Matrix3Xi triangles = RandomTriangles(80, vertices);
    std::map<std::pair<int, int>, std::vector<int>> between;
    for (int h = 0; h < 240; ++h) {
      const int a = triangles(h % 3, h / 3), b = triangles((h + 1) % 3, h / 3);
      between[std::minmax(a, b)].push_back(h);
    }
    const HalfEdges edges = LinkTriangles(triangles, vertices);
    ASSERT_EQ(edges.twin.size(), 240u);
    std::set<std::vector<int>> crowded;
    for (const auto& [ends, all] : between) {
      if (all.size() > 2) crowded.insert(all);
      for (const int h : all) {
        const int twin = all.size() != 2 ? -1 : all[0] == h ? all[1] : all[0];
        EXPECT_EQ(edges.twin[static_cast<size_t>(h)], twin);
      }
    }
    EXPECT_EQ(std::set(edges.crowded.begin(), edges.crowded.end()), crowded);
    EXPECT_EQ(edges.crowded.size(), crowded.size());
  }
}

TEST(HalfEdgesTest, RepeatedTrianglesAreThoseOfTheSameCornersAsOneBefore) {
  const Eigen::Matrix3Xi triangles = RandomTriangles(200, 9);
  const std::vector<bool> repeated = RepeatedTriangles(triangles, 9);
  std::set<std::set<int>> known;
  int count = 0;
  for (int t = 0; t < 200; ++t) {
    const auto corners = triangles.col(t);
    const bool fresh = known.insert({corners.begin(), corners.end()}).second;
    EXPECT_EQ(repeated[static_cast<size_t>(t)], !fresh) << t;
    count += !fresh;
  }
  EXPECT_GT(count, 100);  // of 84 triples there are
}

TEST(PointNumbersTest, EqualPointsHaveOneNumberInTheOrderTheyCome) {
  std::mt19937 random(kSeed);
  PointNumbers points;
  std::map<std::array<double, 3>, int> known;
  for (int k = 0; k < 20000; ++k) {
    std::array<double, 3> point;
    for (double& x : point) x = (static_cast<int>(random() % 31) - 15) * 0.1;
    const int number = known.try_emplace(point, static_cast<int>(known.size())).first->second;
    EXPECT_EQ(points.NumberOf(point.data()), number);
  }
  EXPECT_EQ(points.size(), static_cast<int>(known.size()));
  const std::array<double, 3> zero = {0, 0, 0}, minus = {-0.0, 0, -0.0};
  EXPECT_EQ(points.NumberOf(zero.data()), points.NumberOf(minus.data()));
}

}  // namespace batten::internal::half_edges_test
