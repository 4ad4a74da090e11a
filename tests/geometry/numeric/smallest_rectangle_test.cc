// SPDX-License-Identifier: MIT
#include "geometry/numeric/smallest_rectangle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::smallest_rectangle_test {

std::vector<Eigen::Vector2d> RandomPlaces(RandomSplines& random, int count) {
  std::vector<Eigen::Vector2d> places;
  for (int k = 0; k < count; ++k) places.emplace_back(random.Real(-1, 1), random.Real(-1, 1));
  return places;
}

TEST(ConvexHullOfTest, HoldsAllPointsOnTheLeftOfItsSides) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const auto places = RandomPlaces(random, 3 + static_cast<int>(seed) * 3);
    const auto hull = ConvexHullOf(places);
    ASSERT_GE(hull.size(), 3u);
    for (size_t i = 0; i < hull.size(); ++i) {
      const Eigen::Vector2d side = hull[(i + 1) % hull.size()] - hull[i];
      for (const auto& p : places) {
        const Eigen::Vector2d d = p - hull[i];
        EXPECT_GE(side[0] * d[1] - side[1] * d[0], -kRounding);
      }
    }
  }
}

TEST(ConvexHullOfTest, IsWhatThereIsOfFewPointsAndLines) {
  EXPECT_TRUE(ConvexHullOf({}).empty());
  EXPECT_EQ(ConvexHullOf({{1, 2}, {1, 2}}).size(), 1u);
  EXPECT_EQ(ConvexHullOf({{1, 2}, {3, 4}, {2, 3}, {5, 6}}).size(), 2u);
}

TEST(SmallestRectangleAroundTest, IsNoLargerThanThoseInOtherDirectionsAndHoldsAll) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const auto places = RandomPlaces(random, 4 + static_cast<int>(seed));
    const TurnedRectangle best = SmallestRectangleAround(ConvexHullOf(places));
    for (const auto& p : places) {
      const Eigen::Vector2d q = best.ToFrame(p);
      EXPECT_TRUE((q.array() >= best.low.array() - kRounding).all());
      EXPECT_TRUE((q.array() <= best.high.array() + kRounding).all());
    }
    for (int k = 0; k < 90; ++k) {
      TurnedRectangle other;
      other.axis << std::cos(0.0175 * k), std::sin(0.0175 * k);
      Eigen::Vector2d low = other.ToFrame(places[0]), high = low;
      for (const auto& p : places) {
        low = low.cwiseMin(other.ToFrame(p));
        high = high.cwiseMax(other.ToFrame(p));
      }
      EXPECT_LE(best.area, (high - low).prod() + kRounding);
    }
  }
}

TEST(SmallestRectangleAroundTest, HasNoAreaAroundALine) {
  EXPECT_NEAR(SmallestRectangleAround(ConvexHullOf({{0, 0}, {1, 1}, {3, 3}})).area, 0, kRounding);
}

}  // namespace batten::internal::smallest_rectangle_test
