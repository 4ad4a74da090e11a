// SPDX-License-Identifier: MIT
#include "batten/geometry/fill.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "angles.h"
#include "batten/geometry/make_curve.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/reverse.h"
#include "batten/geometry/split.h"
#include "batten/geometry/transform.h"
#include "random_splines.h"
#include "refusal.h"
#include "tolerances.h"

namespace batten::internal::fill_test {

using ::testing::HasSubstr;

// A cubic graph z = f(x, y), out of which holes are cut.
double Height(double x, double y) {
  return 0.3 * x * x - 0.2 * x * y * y + 0.15 * y * y * y + 0.1 * x * y - 0.1 * y;
}

// The graph between once and twice the segment ab as seen from the origin: x and y are bilinear, so
// that it is one bicubic Bézier piece exactly, found by interpolation of 4 × 4 points of `height`.
template <typename Function>
NurbsSurface Strip(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Function& height) {
  Eigen::Matrix4d bernstein;
  for (int i = 0; i < 4; ++i) {
    const double t = i / 3.0, s = 1 - t;
    bernstein.row(i) << s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t;
  }
  const Eigen::Matrix4d inverse = bernstein.inverse();
  Eigen::Matrix4d x, y, z;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      const Eigen::Vector2d p = (1 + i / 3.0) * ((1 - j / 3.0) * a + j / 3.0 * b);
      x(i, j) = p[0];
      y(i, j) = p[1];
      z(i, j) = height(p[0], p[1]);
    }
  }
  Eigen::Matrix3Xd points(3, 16);
  int row = 0;
  for (const Eigen::Matrix4d* values : {&x, &y, &z}) {
    const Eigen::Matrix4d net = inverse * *values * inverse.transpose();
    points.row(row++) = net.reshaped<Eigen::RowMajor>().transpose();
  }
  const SplineBasis basis(3, {0, 0, 0, 0, 1, 1, 1, 1});
  return NurbsSurface(basis, basis, points);
}

Eigen::Vector2d Corner(int k, int n) {
  return {std::cos(2 * kPi * k / n), 0.8 * std::sin(2 * kPi * k / n)};
}

// Three to six sides with neighbours all round: tangent planes go on within a thousandth of a
// radian, edges within the tolerance, and inside they go on too.
TEST(FillTest, HolesInASmoothSurfaceAreFilledSmoothly) {
  for (int n = 3; n <= 6; ++n) {
    SCOPED_TRACE(n);
    std::vector<FillSide> sides;
    for (int k = 0; k < n; ++k) {
      sides.push_back(
          SideOf(Strip(Corner(k, n), Corner(k + 1, n), Height), {Direction::kU, false}));
    }
    std::rotate(sides.begin() + 1, sides.begin() + 2, sides.end());
    const HoleFill fill = Fill(sides);
    ASSERT_EQ(static_cast<int>(fill.patches.size()), n);
    EXPECT_TRUE(fill.reached);
    EXPECT_LE(fill.spans, 8);
    EXPECT_LE(fill.quality.inner_angle, 1e-4);
    EXPECT_LE(fill.quality.outer_angle, 1e-4);
    // As the test of joins, which knows nothing of the filling, sees it.
    for (int k = 0; k < n; ++k) {
      const SurfaceJoin join =
          TestJoin(fill.patches[k], fill.patches[(k + 1) % n], {.angle_tolerance = 1e-4});
      EXPECT_GE(join.geometric, 1) << k << ": " << join.angle_gap.value_or(-1);
      EXPECT_LE(join.position_gap, kRounding);
    }
    // In the middle it is near the graph that was cut out.
    EXPECT_NEAR(fill.patches[0].At(0, 0)[2],
                Height(fill.patches[0].At(0, 0)[0], fill.patches[0].At(0, 0)[1]),
                0.05);
  }
}

TEST(FillTest, CurvesAloneAreFilledToTheirTolerance) {
  for (int n = 3; n <= 6; ++n) {
    SCOPED_TRACE(n);
    std::vector<FillSide> sides;
    for (int k = 0; k < n; ++k) {
      const Eigen::Vector3d a(Corner(k, n)[0], Corner(k, n)[1], k % 2 ? 0.3 : 0),
          b(Corner(k + 1, n)[0], Corner(k + 1, n)[1], (k + 1) % n % 2 ? 0.3 : 0);
      Eigen::Matrix3Xd points(3, 4);
      points << a, a + (b - a) / 3 + Eigen::Vector3d(0, 0, 0.3),
          a + 2 * (b - a) / 3 + Eigen::Vector3d(0.1, 0, -0.2), b;
      NurbsCurve<3> curve(SplineBasis(3, {0, 0, 0, 0, 1, 1, 1, 1}), points);
      sides.push_back({k % 2 ? Reversed(curve) : curve});
    }
    const HoleFill fill = Fill(sides);
    EXPECT_TRUE(fill.reached);
    EXPECT_EQ(fill.quality.outer_angle, 0);
  }
}

// Neighbours whose tangent planes disagree at their corners can't both be met: that is said, and
// the angle is not much more than theirs.
TEST(FillTest, NeighboursThatDisagreeAreSaid) {
  std::vector<FillSide> sides;
  for (int k = 0; k < 4; ++k) {
    const bool other = k == 2;
    NurbsSurface strip = Strip(Corner(k, 4), Corner(k + 1, 4), Height);
    if (other) {  // bent about its own inner edge
      Eigen::Matrix3Xd points = strip.control_points();
      points.block(2, 4, 1, 12).array() += 0.02;
      strip = NurbsSurface(strip.basis_u(), strip.basis_v(), points);
    }
    sides.push_back(SideOf(strip, {Direction::kU, false}));
  }
  const HoleFill fill = Fill(sides);
  EXPECT_FALSE(fill.reached);
  EXPECT_GT(fill.quality.outer_angle, 1e-2);
  EXPECT_LT(fill.quality.outer_angle, 0.2);
  EXPECT_LE(fill.quality.position_gap, fill.tolerance);
}

// A flat hole with flat neighbours is filled flat.
TEST(FillTest, PlanesStayPlanes) {
  for (int n = 3; n <= 6; ++n) {
    std::vector<FillSide> sides;
    for (int k = 0; k < n; ++k) {
      const auto at = [&](int i, double r) {
        return Eigen::Vector3d(r * Corner(i, n)[0], r * Corner(i, n)[1], 0);
      };
      sides.push_back(SideOf(MakeBilinear(at(k, 1), at(k, 2), at(k + 1, 1), at(k + 1, 2)),
                             {Direction::kU, false}));
    }
    const HoleFill fill = Fill(sides);
    EXPECT_TRUE(fill.reached) << n;
    for (const NurbsSurface& patch : fill.patches) {
      EXPECT_LE(patch.control_points().row(2).cwiseAbs().maxCoeff(), kIterated);
    }
  }
}

// What is filled moves with its sides, in any unit and far from the origin.
TEST(FillTest, PlaceAndUnitDoNotMatter) {
  std::vector<FillSide> sides;
  for (int k = 0; k < 3; ++k)
    sides.push_back(SideOf(Strip(Corner(k, 3), Corner(k + 1, 3), Height), {Direction::kU, false}));
  const FillOptions options{.angle_tolerance = 1e-2, .max_spans = 2};
  const HoleFill plain = Fill(sides, options);
  for (const auto& [scale, shift] : {std::pair{1e-4, 0.0}, {1e3, 5e6}}) {
    const Eigen::Matrix4d map = Translation(Eigen::Vector3d::Constant(shift)) * Scaling(scale);
    std::vector<FillSide> moved;
    for (const FillSide& side : sides)
      moved.push_back(SideOf(Transformed(*side.neighbour, map), side.edge));
    const HoleFill fill = Fill(moved, options);
    ASSERT_EQ(fill.spans, plain.spans);
    for (size_t k = 0; k < 3; ++k) {
      const Eigen::Matrix3Xd back = (fill.patches[k].control_points().array() - shift) / scale;
      EXPECT_LE((back - plain.patches[k].control_points()).cwiseAbs().maxCoeff(), kHalfDigits);
    }
  }
}

TEST(FillTest, WhatIsNoHoleIsRefused) {
  const auto line = [](double x0, double y0, double x1, double y1) {
    return FillSide{MakeLine<3>({x0, y0, 0}, {x1, y1, 0})};
  };
  EXPECT_THAT(RefusalOf([&] {
                Fill({line(0, 0, 1, 0), line(1, 0, 0, 0)});
              }),
              HasSubstr("2 sides; a hole has three to six"));
  EXPECT_THAT(RefusalOf([&] {
                Fill({line(0, 0, 1, 0), line(1, 0.1, 0, 1), line(0, 1, 0, 0)});
              }),
              HasSubstr("is 0.1 away"));
  EXPECT_THAT(RefusalOf([&] {
                Fill({line(0, 0, 1, 0), line(1, 0, 0, 1), line(0, 1, 0, 0.2)});
              }),
              HasSubstr("open by 0.2"));
  EXPECT_THAT(RefusalOf([&] {
                Fill({line(0, 0, 1, 0), line(1, 0, 0, 1), line(0, 1, 0, 0)}, {.tolerance = 0});
              }),
              HasSubstr("tolerance"));
}

}  // namespace batten::internal::fill_test
