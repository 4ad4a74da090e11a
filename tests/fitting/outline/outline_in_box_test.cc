// SPDX-License-Identifier: MIT
#include "fitting/outline/outline_in_box.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

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

}  // namespace batten::internal::outline_in_box_test
