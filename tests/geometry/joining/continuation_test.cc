// SPDX-License-Identifier: MIT
#include "batten/geometry/continuation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "batten/geometry/make_surface.h"
#include "random_splines.h"
#include "refusal.h"
#include "tolerances.h"

namespace batten::internal::continuation_test {

using ::testing::HasSubstr;

JoinFreedom RandomFreedom(RandomSplines& random, bool rational) {
  JoinFreedom freedom{.beta = random.Real(0.3, 2), .beta2 = random.Real(-1, 1)};
  if (rational) {
    freedom.alpha = random.Real(0.5, 2);
    freedom.eta = random.Real(-0.2, 0.2);
    freedom.eta2 = random.Real(-0.2, 0.2);
  }
  return freedom;
}

// Whatever the freedom: the join test finds G1 or G2, and no more is promised of the derivatives.
TEST(ContinuationTest, CurvesGoOnWithTheOrderAsked) {
  RandomSplines random(51);
  int made = 0;
  for (int k = 0; k < 300; ++k) {
    SCOPED_TRACE(k);
    const bool rational = random.Coin(), upper = random.Coin();
    NurbsCurve<3> curve =
        random.Curve<3>(random.Integer(2, 5), false, {.clamped = random.Coin(), .most_spans = 2});
    if (rational)
      curve = NurbsCurve<3>(
          curve.basis(), curve.control_points(), random.Weights(curve.basis().size(), 0.5, 2));
    const JoinFreedom freedom = RandomFreedom(random, rational);
    const int order = random.Integer(1, 2);
    const Eigen::Vector3d to = random.Vector(3);
    const auto make = [&] {
      return Continued<3>(curve, upper, order, to, freedom, random.Real(0.5, 2));
    };
    if (RefusalOf(make) != "accepted") continue;
    ++made;
    const NurbsCurve<3> next = make();
    const CurveJoin join = TestJoin(curve, next, {.position_tolerance = kIterated});
    EXPECT_GE(join.geometric, order);
    EXPECT_EQ(join.at[1], 0);
    EXPECT_LE((next.At(1) - to).norm(), kRounding * 10);
    const double speed =
        curve.JetAt(upper ? curve.basis().upper() : curve.basis().lower()).first.norm();
    EXPECT_NEAR(next.JetAt(0).first.norm(), freedom.beta * speed, kIterated * speed);
  }
  EXPECT_GT(made, 150);
}

TEST(ContinuationTest, WithoutFreedomDerivativesAreEqual) {
  RandomSplines random(52);
  for (int k = 0; k < 50; ++k) {
    const NurbsCurve<2> curve = random.Curve<2>(3, false);
    const NurbsCurve<2> next = Continued<2>(curve, true, 2, {4, 5});
    EXPECT_EQ(TestJoin(curve, next).parametric, 2);
  }
}

TEST(ContinuationTest, SurfacesGoOnAlongTheWholeEdge) {
  RandomSplines random(53);
  int made = 0;
  for (int k = 0; k < 40; ++k) {
    SCOPED_TRACE(k);
    const bool rational = random.Coin();
    NurbsSurface surface = random.Sheet(random.Integer(2, 4),
                                        random.Integer(1, 4),
                                        0.4,
                                        {.most_spans = 3, .highest_multiplicity = 1});
    if (rational) {
      surface = NurbsSurface(surface.basis_u(),
                             surface.basis_v(),
                             surface.control_points(),
                             random.Weights(surface.control_points().cols(), 0.8, 1.25));
    }
    const int order = random.Integer(1, 2);
    const SurfaceEdge edge{Direction::kU, random.Coin()};
    const JoinFreedom freedom = RandomFreedom(random, rational);
    const auto make = [&] {
      return Continued(surface, edge, order, {edge.upper ? 3.0 : -3.0, 0, 0.5}, freedom);
    };
    if (RefusalOf(make) != "accepted") continue;
    ++made;
    const SurfaceJoin join = TestJoin(surface, make());
    EXPECT_GE(join.geometric, order) << join.position_gap << ' ' << join.angle_gap.value_or(-1)
                                     << ' ' << join.curvature_gap.value_or(-1);
    EXPECT_EQ(join.edges[0], edge);
  }
  EXPECT_GT(made, 25);
}

TEST(ContinuationTest, WhatCannotBeIsRefused) {
  RandomSplines random(54);
  const NurbsCurve<2> curve = random.Curve<2>(3, false);
  EXPECT_THAT(RefusalOf([&] { Continued<2>(curve, true, 3, {0, 0}); }), HasSubstr("order = 3"));
  EXPECT_THAT(RefusalOf([&] {
                Continued<2>(curve, true, 1, {0, 0}, {.beta = 0});
              }),
              HasSubstr("beta"));
  EXPECT_THAT(RefusalOf([&] {
                Continued<2>(curve, true, 1, {0, 0}, {.eta = -5});
              }),
              HasSubstr("weight becomes"));
  EXPECT_THAT(RefusalOf([&] {
                Continued<2>(curve, true, 1, {NAN, 0});
              }),
              HasSubstr("to is not finite"));
  const NurbsSurface ball = MakeSphere(Frame(), 1);
  EXPECT_THAT(RefusalOf([&] {
                Continued(ball, {Direction::kV, true}, 1, {0, 0, 1});
              }),
              HasSubstr("single point"));
}

}  // namespace batten::internal::continuation_test
