// SPDX-License-Identifier: MIT
#include "batten/fitting/trim_to_points.h"

#include <gtest/gtest.h>

#include <vector>

#include "batten/geometry/trim_loops.h"

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

TEST(LoopsThatGoTogetherTest, AreNoneWhereTheOuterOneCrossesItself) {
  const NurbsSurface trimmed =
      WithLoops({Polygon({{1, 1}, {9, 9}, {9, 1}, {1, 9.5}}), Square(2, 4, 0.5)});
  const CompatibleLoops found = LoopsThatGoTogether(trimmed);
  EXPECT_TRUE(found.loops.empty());
  EXPECT_EQ(found.left_out, 2);
}

}  // namespace batten::internal::trim_to_points_test
