// SPDX-License-Identifier: MIT
#include "batten/geometry/ruled_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "batten/geometry/arc_length.h"
#include "batten/geometry/classify_shape.h"
#include "batten/geometry/make_curve.h"
#include "construction_cases.h"
#include "refusal.h"
#include "tolerances.h"

namespace batten::internal::ruled_surface_test {

using ::testing::HasSubstr;

TEST(ExtrudeTest, MovesTheProfileAlongTheVector) {
  for (int seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const auto curve =
        random.Curve<3>(random.Integer(1, 5), random.Coin(), {.periodic = random.Coin()});
    const Eigen::Vector3d by = random.Vector(3);
    if ((curve.control_points().colwise() - curve.control_points().col(0)).isZero(0)) continue;
    const NurbsSurface surface = Extrude(curve, by);
    EXPECT_EQ(surface.basis_u(), curve.basis());
    for (int k = 0; k < 10; ++k) {
      const double u = random.Parameter(curve.basis()), v = random.Real(0, 1);
      EXPECT_LE((surface.At(u, v) - (curve.At(u) + v * by)).norm(), 10 * kRounding);
    }
  }
  EXPECT_TRUE(std::holds_alternative<CylinderShape>(
      ClassifyShape(Extrude(MakeArc(Frame(), 2), {0, 0, 3}))));
  EXPECT_THAT(RefusalOf([] { Extrude(MakeArc(Frame(), 2), {0, 0, 0}); }), HasSubstr("length 0"));
  EXPECT_THAT(RefusalOf([] {
                Extrude(MakeArc(Frame({5e6, 0, 0}, {0, 0, 1}), 2), {0, 0, 1e-10});
              }),
              HasSubstr("too little"));
  EXPECT_THAT(RefusalOf([] {
                Extrude(MakeLine<3>({0, 0, 0}, {1, 2, 3}), {-2, -4, -6});
              }),
              HasSubstr("no area"));
}

TEST(RuledTest, LinesJoinPointsOfEqualShare) {
  for (int seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const auto a =
        NearSegment(random, {0, 0, 0}, {3, 0, 0}, 0.4, random.Integer(1, 4), random.Coin());
    const auto b =
        NearSegment(random, {0, 2, 0}, {3, 2, 1}, 0.4, random.Integer(1, 4), random.Coin());
    const RuledSurface ruled = Ruled(a, b);
    EXPECT_EQ(ruled.error, 0);
    for (int k = 0; k <= 20; ++k) {
      const double u = k / 20.0;
      const Eigen::Vector3d from = AtShare(a, u), to = AtShare(b, u);
      EXPECT_LE((ruled.surface.At(u, 0) - from).norm(), 100 * kRounding);
      EXPECT_LE((ruled.surface.At(u, 1) - to).norm(), 100 * kRounding);
      const Eigen::Vector3d inside = ruled.surface.At(u, random.Real(0, 1)) - from;
      EXPECT_LE(inside.cross((to - from).normalized()).norm(), 1e3 * kRounding);
    }
  }
}

TEST(RuledTest, ByLengthLinesJoinPlacesOfEqualLength) {
  for (int seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const auto a =
        NearSegment(random, {0, 0, 0}, {3, 0, 0}, 0.3, random.Integer(1, 3), random.Coin());
    const auto b =
        NearSegment(random, {0, 2, 0}, {5, 2, 1}, 0.3, random.Integer(1, 3), random.Coin());
    constexpr double kTolerance = 1e-6;
    const RuledSurface ruled = Ruled(a, b, {RuledBy::kLength, kTolerance});
    EXPECT_LE(ruled.error, kTolerance);
    const ArcLengthMap first(a), second(b);
    for (int k = 0; k <= 100; ++k) {
      const double u = k / 100.0;
      const double at = a.basis().lower() + u * (a.basis().upper() - a.basis().lower());
      const double share = first.LengthAt(at) / first.length();
      EXPECT_LE((ruled.surface.At(u, 1) - b.At(second.ParameterAt(share * second.length()))).norm(),
                kTolerance);
    }
  }
}

TEST(RuledTest, APointMakesACone) {
  const NurbsCurve<3> tip(SplineBasis(1, {0, 0, 1, 1}), Eigen::Vector3d(0, 0, 3).replicate<1, 2>());
  const RuledSurface cone = Ruled(MakeArc(Frame(), 2), tip);
  EXPECT_TRUE(std::holds_alternative<ConeShape>(ClassifyShape(cone.surface)));
}

TEST(RuledTest, Refusals) {
  const NurbsCurve<3> circle = MakeArc(Frame(), 2);
  EXPECT_THAT(RefusalOf([&] {
                Ruled(circle, MakeLine<3>({0, 0, 1}, {0, 3, 1}));
              }),
              HasSubstr("curve 1 is closed and curve 2 is open, its ends 3 apart"));
  EXPECT_THAT(RefusalOf([&] { Ruled(circle, circle); }), HasSubstr("are one"));
  EXPECT_THAT(RefusalOf([&] {
                Ruled(circle, circle, {RuledBy::kLength, 0});
              }),
              HasSubstr("tolerance"));
}

}  // namespace batten::internal::ruled_surface_test
