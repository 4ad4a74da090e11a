// SPDX-License-Identifier: MIT
#include "fitting/wings/wing_layout.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "wings.h"

namespace batten::internal::wing_layout_test {

WingParameters LayoutOf(const Eigen::Matrix3Xd& points, double noise, int threads = 2) {
  ThreadPool pool(threads);
  return LayWing(points, NeighbourIndex(points), noise, 0, pool);
}

Eigen::Matrix3Xd Turned(const Eigen::Matrix3Xd& points) {
  const Eigen::Matrix3d turn = Eigen::Quaterniond(0.3, -0.5, 0.7, 0.4).normalized().matrix();
  return turn * points;
}

// Law: parameters run with the place round the section and along the span, whatever the turn in
// space: sides are not mixed up, but for points whose side noise hides.
TEST(WingLayoutTest, ParametersFollowTheSection) {
  const WingCloud cloud = PointsOverWing(MapOf({.sweep = 0.5, .twist = 0.1}), 20000, 5e-4, 3);
  const WingParameters wing = LayoutOf(Turned(cloud.points), 5e-4);
  ASSERT_EQ(wing.failure_reason, "");
  Eigen::Index mixed = 0, judged = 0, agreeing = 0;
  for (Eigen::Index k = 0; k < cloud.at.cols(); ++k) {
    const double u = cloud.at(0, k), from_nose = std::abs(u - 0.5);
    if (from_nose < 0.05 || from_nose > 0.48) continue;
    ++judged;
    agreeing += (wing.parameters(0, k) < wing.length_u / 2) == (u < 0.5) ? 1 : 0;
  }
  mixed = std::min(agreeing, judged - agreeing);
  EXPECT_LE(static_cast<double>(mixed), 1e-3 * static_cast<double>(judged));
}

// Law: the edge is within a third of a spacing of where the sections end.
TEST(WingLayoutTest, FindsTheEdge) {
  const WingMap map = MapOf({.thickness = 0.15, .taper = 0.6});
  const WingCloud cloud = PointsOverWing(map, 30000, 5e-4, 4);
  const WingParameters wing = LayoutOf(cloud.points, 5e-4);
  ASSERT_EQ(wing.failure_reason, "");
  const double spacing = 0.012;
  for (int k = 1; k < 20; ++k) {
    double nearest = HUGE_VAL;
    for (int i = 0; i <= 4000; ++i)
      nearest =
          std::min(nearest, (wing.edge->At(wing.length_v * i / 4000) - map(0, k / 20.0)).norm());
    EXPECT_LT(nearest, spacing / 3);
  }
}

TEST(WingLayoutTest, IsTheSameForEveryNumberOfThreads) {
  const WingCloud cloud = PointsOverWing(MapOf({}), 15000, 5e-4, 6);
  const WingParameters one = LayoutOf(cloud.points, 5e-4, 1), two = LayoutOf(cloud.points, 5e-4, 2);
  ASSERT_EQ(one.failure_reason, "");
  EXPECT_EQ(one.parameters, two.parameters);
}

// Law: round ends are no sharp edge, nor is a single sheet a section.
TEST(WingLayoutTest, RefusesWhatHasNoSharpEdge) {
  for (const double thickness : {0.24, 0.12}) {
    const WingCloud cloud = PointsOverWing(EllipticTube(thickness, 2), 30000, 5e-4, 7);
    EXPECT_NE(LayoutOf(cloud.points, 5e-4).failure_reason, "") << thickness;
  }
  const auto sheet = [](double u, double v) {
    return Eigen::Vector3d(u, v, 0.1 * std::sin(3 * u) * std::cos(2 * v));
  };
  EXPECT_NE(LayoutOf(PointsOverWing(sheet, 20000, 5e-4, 8).points, 5e-4).failure_reason, "");
}

}  // namespace batten::internal::wing_layout_test
