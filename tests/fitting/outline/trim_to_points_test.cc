// SPDX-License-Identifier: MIT
#include "batten/fitting/trim_to_points.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "batten/geometry/trim_loops.h"
#include "geometry/editing/loop_nesting.h"

namespace batten::internal::trim_to_points_test {

NurbsCurve<2> Polygon(const std::vector<Eigen::Vector2d>& corners) {
  const auto count = static_cast<Eigen::Index>(corners.size());
  Eigen::Matrix2Xd points(2, count + 1);
  for (Eigen::Index k = 0; k <= count; ++k) points.col(k) = corners[static_cast<size_t>(k % count)];
  return NurbsCurve<2>(
      SplineBasis::Uniform(1, static_cast<int>(count) + 1, 0, static_cast<double>(count)), points);
}

NurbsCurve<2> Square(double u, double v, double side) {
  return Polygon({{u, v}, {u, v + side}, {u + side, v + side}, {u + side, v}});
}

NurbsSurface Plane() {
  Eigen::Matrix3Xd net(3, 4);
  net << 0, 0, 10, 10, 0, 10, 0, 10, 0, 0, 0, 0;
  return NurbsSurface(SplineBasis::Uniform(1, 2, 0, 10), SplineBasis::Uniform(1, 2, 0, 10), net);
}

NurbsSurface WithLoops(std::vector<NurbsCurve<2>> loops) {
  return Plane().WithTrims(TurnedLoops(std::move(loops)));
}

// Its two halves are of different size, so that it bounds some area.
NurbsCurve<2> Eight(double u, double v) {
  return Polygon({{u, v}, {u + 1, v + 1}, {u + 1, v}, {u, v + 1.5}});
}

TEST(LoopsThatGoTogetherTest, AreAllWhereNoneCrosses) {
  const NurbsSurface trimmed =
      WithLoops({Square(0.5, 0.5, 9), Square(1, 1, 2), Square(4, 4, 1), Square(7, 2, 1)});
  const CompatibleLoops found = LoopsThatGoTogether(trimmed);
  EXPECT_EQ(found.left_out, 0);
  EXPECT_EQ(found.loops.size(), 4u);
}

TEST(LoopsThatGoTogetherTest, LeaveOutWhatCrossesItselfOrALargerOne) {
  const NurbsSurface trimmed = WithLoops({Square(0.5, 0.5, 9),
                                          Eight(6, 6),
                                          Square(1, 1, 2),
                                          Square(2.5, 2.5, 1),  // over a corner of the last
                                          Square(8.9, 4, 0.9),  // beyond the outer one
                                          Square(4, 7, 1)});
  EXPECT_THROW(CheckTrims(trimmed), std::invalid_argument);
  const CompatibleLoops found = LoopsThatGoTogether(trimmed);
  EXPECT_EQ(found.left_out, 3);
  ASSERT_EQ(found.loops.size(), 3u);
  EXPECT_NO_THROW(CheckTrims(Plane().WithTrims(found.loops)));
  EXPECT_EQ(found.loops[1].control_points(),
            WithLoops({Square(0.5, 0.5, 9), Square(1, 1, 2)}).trims()[1].control_points());
}

TEST(LoopsThatGoTogetherTest, KeepIslandsWithinHolesWhereALoopIsLeftOut) {
  const NurbsSurface trimmed =
      Plane().WithTrims({Polygon({{0.5, 0.5}, {9.5, 0.5}, {9.5, 9.5}, {0.5, 9.5}}),
                         Square(2, 2, 4),
                         Polygon({{3, 3}, {5, 3}, {5, 5}, {3, 5}}),  // an island in it …
                         Square(3.5, 3.5, 1),                        // … and its lake
                         Square(8.9, 4, 0.9)});                      // beyond the outer one
  const CompatibleLoops found = LoopsThatGoTogether(trimmed);
  EXPECT_EQ(found.left_out, 1);
  ASSERT_EQ(found.loops.size(), 4u);
  for (size_t k = 0; k < 4; ++k)
    EXPECT_EQ(found.loops[k].control_points(), trimmed.trims()[k].control_points());
  EXPECT_NO_THROW(CheckTrims(Plane().WithTrims(found.loops)));
}

TEST(LoopsThatGoTogetherTest, AreNoneWhereTheOuterOneCrossesItself) {
  const NurbsSurface trimmed =
      WithLoops({Polygon({{1, 1}, {9, 9}, {9, 1}, {1, 9.5}}), Square(2, 4, 0.5)});
  const CompatibleLoops found = LoopsThatGoTogether(trimmed);
  EXPECT_TRUE(found.loops.empty());
  EXPECT_EQ(found.left_out, 2);
}

// A square of side 2 in space; along u its parameter is stretched threefold to both sides of its
// middle, x = u (0.1 + 0.9 u²).
NurbsSurface StretchedSquare() {
  Eigen::Matrix3Xd net(3, 8);
  const double x[] = {-1, 13.0 / 15, -13.0 / 15, 1};  // by blossoms
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 2; ++j) net.col(2 * i + j) = Eigen::Vector3d(x[i], 2 * j - 1, 0);
  return NurbsSurface(SplineBasis::Uniform(3, 4, -1, 1), SplineBasis::Uniform(1, 2, -1, 1), net);
}

// Parameters of points that lie evenly at random in space, without those in a disc about (0.5, 0).
Eigen::Matrix2Xd EvenFeet(int count, double disc, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Eigen::Vector2d> feet;
  while (static_cast<int>(feet.size()) < count) {
    const double x = uniform(random), y = uniform(random);
    if (std::hypot(x - 0.5, y) < disc) continue;
    double u = x;
    for (int k = 0; k < 60; ++k) u -= (0.1 * u + 0.9 * u * u * u - x) / (0.1 + 2.7 * u * u);
    feet.emplace_back(u, y);
  }
  Eigen::Matrix2Xd result(2, count);
  for (int k = 0; k < count; ++k) result.col(k) = feet[static_cast<size_t>(k)];
  return result;
}

TEST(TrimToPointsTest, CutsNoHoleWhereOnlyTheParametersAreStretched) {
  ThreadPool pool(2);
  for (const unsigned seed : {1U, 2U, 3U}) {
    const PointTrim trim = TrimToPoints(
        StretchedSquare(), EvenFeet(20000, 0, seed), {}, 2 / std::sqrt(20000), 0, pool);
    int holes = 0;
    for (const NurbsCurve<2>& loop : trim.surface.trims()) holes += SignedArea(loop) < 0;
    EXPECT_EQ(holes, 0) << seed;
  }
}

TEST(TrimToPointsTest, CutsAHoleThatIsOneInSpace) {
  ThreadPool pool(2);
  for (const unsigned seed : {1U, 2U, 3U}) {
    const PointTrim trim = TrimToPoints(
        StretchedSquare(), EvenFeet(20000, 0.1, seed), {}, 2 / std::sqrt(20000), 0, pool);
    double area = 0;  // in space: of the middles of small cells inside
    const int cells = 400;
    for (const NurbsCurve<2>& loop : trim.surface.trims()) {
      if (SignedArea(loop) > 0) continue;
      const Eigen::Matrix2Xd polygon = NestingPolygon(loop);
      for (int i = 0; i < cells; ++i)
        for (int j = 0; j < cells; ++j) {
          const Eigen::Vector2d at(-1 + (2 * i + 1.0) / cells, -1 + (2 * j + 1.0) / cells);
          if (InsidePolygon(polygon, at)) area += 4.0 / cells / cells * (0.1 + 2.7 * at[0] * at[0]);
        }
    }
    EXPECT_NEAR(area, std::numbers::pi * 0.01, 0.2 * std::numbers::pi * 0.01) << seed;
  }
}

}  // namespace batten::internal::trim_to_points_test
