// SPDX-License-Identifier: MIT
#include "fitting/outline/outline_in_box.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "batten/fitting/refused_data.h"

namespace batten::internal::outline_in_box_test {

// A disc of points in a rectangle many times as wide.
TEST(FindOutlineInBoxTest, LiesAroundThePointsWhereverTheyAre) {
  std::mt19937_64 engine(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Eigen::Vector2d centre(7, 4);
  constexpr int kPoints = 8000;
  Eigen::Matrix2Xd points(2, kPoints);
  for (int k = 0; k < kPoints;) {
    const Eigen::Vector2d place(uniform(engine), uniform(engine));
    if (place.norm() < 1) points.col(k++) = centre + place;
  }
  OutlineOptions options;
  options.spacing = std::sqrt(std::acos(-1.0) / kPoints);
  options.length_u = 20;
  options.length_v = 9;
  ThreadPool pool(2);
  const Outline outline = FindOutlineInBox(points, options, pool);
  EXPECT_FALSE(outline.fills);
  ASSERT_EQ(outline.loops.size(), 1u);
  const NurbsCurve<2>& loop = outline.loops.front().loop;
  for (int k = 0; k < 200; ++k) {
    const double at =
        loop.basis().lower() + (loop.basis().upper() - loop.basis().lower()) * k / 200;
    EXPECT_NEAR((loop.At(at) - centre).norm(), 1, 1.2 * options.spacing);
  }
}

// Points of a strip about as wide as their spacing: where nothing is left of their border, a
// sentence on the points says so.
TEST(FindOutlineInBoxTest, AStripOfASpacingIsRefusedInWordsOfThePoints) {
  std::mt19937_64 engine(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  ThreadPool pool(2);
  int refused = 0;
  for (const double width : {0.05, 0.1, 0.2, 0.5, 1.0}) {
    Eigen::Matrix2Xd points(2, 5000);
    for (auto point : points.colwise()) {
      // Longer gaps cut it into parts.
      const double along = 1700 * std::pow(uniform(engine), 2);
      point << 1 + width * uniform(engine), along;
    }
    OutlineOptions options;
    options.spacing = 1;
    options.length_u = 2.3;
    options.length_v = 1702;
    try {
      FindOutlineInBox(points, options, pool);
    } catch (const RefusedData& refusal) {
      ++refused;
      EXPECT_NE(std::string(refusal.what()).find("along a line"), std::string::npos);
    }
  }
  EXPECT_GT(refused, 0);
}

}  // namespace batten::internal::outline_in_box_test
