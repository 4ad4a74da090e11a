// SPDX-License-Identifier: MIT
#include "fitting/outline/four_sides.h"

#include <gtest/gtest.h>

#include <string>

#include "outlined_clouds.h"

namespace batten::internal::four_sides_test {

std::optional<std::vector<NurbsCurve<2>>> SidesOf(const OutlinedCloud& cloud) {
  OutlineOptions options;
  options.spacing = 1;
  options.length_u = cloud.length_u;
  options.length_v = cloud.length_v;
  ThreadPool pool(2);
  const Outline outline = FindOutline(cloud.points, options, pool);
  if (outline.loops.empty()) return {};
  return FourSides(outline.loops.front());
}

// From corner to corner, the lower one first, each within two spacings of its true place; three
// where the straight sides are only some forty long.
void ExpectSides(int count, Scatter scatter, unsigned seed) {
  SCOPED_TRACE(std::to_string(count) + " points, scatter " +
               std::to_string(static_cast<int>(scatter)) + ", seed " + std::to_string(seed));
  const OutlinedCloud cloud = CloudIn(WavyShape(), count, scatter, seed, 0.0);
  const double near = count < 10000 ? 3 : 2;
  const auto sides = SidesOf(cloud);
  ASSERT_TRUE(sides);
  const Places& corners = cloud.shape.corners;
  const Eigen::Vector2d places[4] = {corners[0], corners[2], corners[3], corners[1]};
  for (size_t k = 0; k < 4; ++k) {
    const NurbsCurve<2>& side = (*sides)[k];
    const Eigen::Vector2d end = side.At(side.basis().upper());
    const NurbsCurve<2>& next = (*sides)[(k + 1) % 4];
    EXPECT_EQ(end, next.At(next.basis().lower()));
    EXPECT_LE((side.At(side.basis().lower()) - places[k]).norm(), near);
    for (int i = 0; i <= 100; ++i) {
      const double t =
          side.basis().lower() + (side.basis().upper() - side.basis().lower()) * i / 100;
      EXPECT_LE(DistanceTo(cloud.shape.loops[0], side.At(t)), i < 8 || i > 92 ? near : 1);
    }
  }
}

TEST(FourSidesTest, AWavySheetHasFour) {
  for (const Scatter scatter : {Scatter::kRandom, Scatter::kJittered, Scatter::kGrid})
    for (unsigned seed = 1; seed <= 5; ++seed) {
      ExpectSides(2000, scatter, seed);
      ExpectSides(20000, scatter, seed);
    }
}

TEST(LongFourSidesTest, ALargeWavySheetHasFour) {
  for (const Scatter scatter : {Scatter::kRandom, Scatter::kJittered, Scatter::kGrid})
    for (unsigned seed = 1; seed <= 3; ++seed) ExpectSides(100000, scatter, seed);
}

TEST(FourSidesTest, OtherOutlinesHaveNot) {
  for (const OutlinedShape& shape :
       {DiscShape(), LShape(), StarShape(), CrescentShape(), PlateShape(), RingShape()})
    for (unsigned seed = 1; seed <= 2; ++seed) {
      SCOPED_TRACE(shape.name + ", seed " + std::to_string(seed));
      EXPECT_FALSE(SidesOf(CloudIn(shape, 5000, Scatter::kRandom, seed, 0.0)));
    }
}

// A rectangle with a hole: straight sides, exactly.
TEST(FourSidesTest, ARectangleHasItsOwn) {
  OutlinedShape shape = RectangleShape();
  shape.loops.push_back(EllipseLoop(0.5, 0.35, 0.15, 0.15));
  const OutlinedCloud cloud = CloudIn(shape, 10000, Scatter::kRandom, 1, 0.5);
  const auto sides = SidesOf(cloud);
  ASSERT_TRUE(sides);
  EXPECT_EQ((*sides)[0].control_points().col(3), Eigen::Vector2d(cloud.length_u, 0));
  EXPECT_EQ((*sides)[2].control_points().col(3), Eigen::Vector2d(0, cloud.length_v));
  EXPECT_EQ((*sides)[3].basis().degree(), 3);
}

}  // namespace batten::internal::four_sides_test
