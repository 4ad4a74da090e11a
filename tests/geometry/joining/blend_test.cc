// SPDX-License-Identifier: MIT
#include "batten/geometry/blend.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "batten/geometry/classify_shape.h"
#include "batten/geometry/make_curve.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/reverse.h"
#include "batten/geometry/split.h"
#include "batten/geometry/transform.h"
#include "random_splines.h"
#include "refusal.h"
#include "tolerances.h"

namespace batten::internal::blend_test {

using ::testing::HasSubstr;

TEST(BlendTest, CurvesMeetWithTheContinuityAsked) {
  RandomSplines random(61);
  int made = 0;
  for (int k = 0; k < 200; ++k) {
    SCOPED_TRACE(k);
    const auto draw = [&] {
      NurbsCurve<3> curve =
          random.Curve<3>(random.Integer(2, 5), false, {.clamped = random.Coin(), .most_spans = 2});
      if (random.Coin()) return curve;
      return NurbsCurve<3>(
          curve.basis(), curve.control_points(), random.Weights(curve.basis().size(), 0.6, 1.6));
    };
    const NurbsCurve<3> first = draw(), second = Transformed(draw(), Translation({3, 1, 0}));
    const BlendOptions options{.continuity = random.Integer(0, 2),
                               .fullness = {random.Real(0.2, 1.5), random.Real(0.2, 1.5)}};
    const CurveEnds ends{random.Coin(), random.Coin()};
    const auto make = [&] { return Blend(first, second, options, ends); };
    if (RefusalOf(make) != "accepted") continue;
    ++made;
    const NurbsCurve<3> blend = make();
    EXPECT_EQ(blend.basis().degree(), 2 * options.continuity + 1);
    EXPECT_GE(TestJoin(first, blend).geometric, options.continuity);
    EXPECT_GE(TestJoin(blend, second).geometric, options.continuity);
  }
  EXPECT_GT(made, 120);
}

TEST(BlendTest, TheNearestEndsAreTaken) {
  const NurbsCurve<2> a = MakeLine<2>({0, 0}, {1, 0}), b = MakeLine<2>({5, 1}, {2, 1});
  const NurbsCurve<2> blend = Blend(a, b);
  EXPECT_EQ(blend.At(0), Eigen::Vector2d(1, 0));
  EXPECT_EQ(blend.At(1), Eigen::Vector2d(2, 1));
  const NurbsCurve<2> far = Blend(a, b, {}, CurveEnds{false, false});
  EXPECT_EQ(far.At(1), Eigen::Vector2d(5, 1));
  // Between two parts of one line it is the line.
  const NurbsCurve<2> straight = Blend(a, MakeLine<2>({2, 0}, {3, 0}));
  EXPECT_EQ(NameOf(ClassifyShape(straight)), "line");
}

TEST(BlendTest, SurfacesMeetAlongTheWholeEdge) {
  RandomSplines random(62);
  int made = 0;
  for (int k = 0; k < 40; ++k) {
    SCOPED_TRACE(k);
    const auto draw = [&] {
      NurbsSurface sheet = random.Sheet(random.Integer(2, 4),
                                        random.Integer(2, 4),
                                        0.4,
                                        {.most_spans = 3, .highest_multiplicity = 1});
      if (random.Coin()) {
        sheet = NurbsSurface(sheet.basis_u(),
                             sheet.basis_v(),
                             sheet.control_points(),
                             random.Weights(sheet.control_points().cols(), 0.8, 1.25));
      }
      if (random.Coin()) sheet = Reversed(sheet, Direction::kV);
      return random.Coin() ? Swapped(sheet) : sheet;
    };
    const NurbsSurface first = draw(), second = Transformed(draw(), Translation({14, 1, 2}));
    const BlendOptions options{.continuity = random.Integer(0, 2),
                               .fullness = {random.Real(0.3, 1.2), random.Real(0.3, 1.2)}};
    const auto make = [&] { return Blend(first, second, options); };
    if (RefusalOf(make) != "accepted") continue;
    ++made;
    const SurfaceBlend blend = make();
    const SurfaceJoin from = TestJoin(first, blend.surface), to = TestJoin(blend.surface, second);
    EXPECT_GE(from.geometric, options.continuity)
        << from.angle_gap.value_or(-1) << ' ' << from.curvature_gap.value_or(-1);
    EXPECT_GE(to.geometric, options.continuity)
        << to.angle_gap.value_or(-1) << ' ' << to.curvature_gap.value_or(-1);
    EXPECT_EQ(from.edges[0], blend.edges[0]);
    EXPECT_EQ(to.edges[1], blend.edges[1]);
  }
  EXPECT_GT(made, 25);
}

// Two pieces of a cylinder: rational, and the weights stay those of the arc.
TEST(BlendTest, RoundSurfacesKeepTheirWeights) {
  const NurbsSurface tube = MakeCylinder(Frame(), 2, {0, 9}, {0, 2});
  const NurbsSurface low = Segment(tube, Direction::kV, 0, 0.3),
                     high = Segment(tube, Direction::kV, 0.7, 1);
  const SurfaceBlend blend = Blend(low, high);
  EXPECT_EQ(TestJoin(low, blend.surface).geometric, 2);
  EXPECT_EQ(NameOf(ClassifyShape(blend.surface)), "cylinder");
}

TEST(BlendTest, WhatCannotBeIsRefused) {
  const NurbsCurve<2> a = MakeLine<2>({0, 0}, {1, 0}), b = MakeLine<2>({1, 0}, {2, 1});
  EXPECT_THAT(RefusalOf([&] { Blend(a, b); }), HasSubstr("nothing between"));
  EXPECT_THAT(RefusalOf([&] { Blend(a, b, {.continuity = 3}); }), HasSubstr("continuity = 3"));
  EXPECT_THAT(RefusalOf([&] { Blend(a, b, {.fullness = {0, 1}}); }), HasSubstr("fullness"));
  const NurbsSurface ball = MakeSphere(Frame(), 1),
                     plane = MakePlane(Frame({5, 0, 0}, {0, 0, 1}), {-1, 1}, {-1, 1});
  EXPECT_THAT(RefusalOf([&] {
                Blend(ball, plane, {}, SurfaceEdge{Direction::kV, true});
              }),
              HasSubstr("single point"));
  EXPECT_THAT(RefusalOf([&] {
                Blend(MakeCylinder(Frame(), 1, {0, 2}),
                      plane,
                      {},
                      SurfaceEdge{Direction::kV, true},
                      SurfaceEdge{Direction::kU, false});
              }),
              HasSubstr("one edge closes and the other is open, its ends 2 apart"));
  EXPECT_THAT(RefusalOf([&] { Blend(a, b, {.fullness = {1e9, 1}}); }), HasSubstr("more than 100"));
}

}  // namespace batten::internal::blend_test
