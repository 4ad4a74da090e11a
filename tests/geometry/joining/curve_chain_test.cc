// SPDX-License-Identifier: MIT
#include "batten/geometry/curve_chain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "angles.h"
#include "batten/geometry/foot_point.h"
#include "batten/geometry/make_curve.h"
#include "batten/geometry/reverse.h"
#include "batten/geometry/transform.h"
#include "random_splines.h"
#include "refusal.h"
#include "tolerances.h"

namespace batten::internal::curve_chain_test {

using ::testing::HasSubstr;

// A line, half a circle, a free cubic and a parabola, end to end.
std::vector<NurbsCurve<3>> Outline(RandomSplines& random) {
  std::vector<NurbsCurve<3>> curves{MakeLine<3>({0, 0, 0}, {4, 0, 0}),
                                    MakeArc(Frame({4, 2, 0}, {0, 0, 1}), 2, {-kPi / 2, kPi})};
  Eigen::Matrix3Xd points(3, 5);
  points.col(0) = Eigen::Vector3d(4, 4, 0);
  for (int k = 1; k < 5; ++k) points.col(k) = Eigen::Vector3d(4 - k, 4, 0) + random.Vector(0.8);
  curves.emplace_back(SplineBasis(3, {0, 0, 0, 0, 0.4, 1, 1, 1, 1}), points);
  Eigen::Matrix3Xd parabola(3, 3);
  parabola << points.col(4), Eigen::Vector3d(-2, 3, 0), Eigen::Vector3d(-1, 1, 0);
  curves.emplace_back(SplineBasis(2, {0, 0, 0, 1, 1, 1}), parabola);
  return curves;
}

TEST(CurveChainTest, EveryPieceIsTracedExactlyInAnyOrderAndSense) {
  RandomSplines random(71);
  for (int k = 0; k < 50; ++k) {
    SCOPED_TRACE(k);
    std::vector<NurbsCurve<3>> curves = Outline(random);
    const std::vector<NurbsCurve<3>> originals = curves;
    for (size_t i = 1; i < curves.size(); ++i) {
      std::swap(curves[i], curves[random.Integer(1, 3)]);
      if (random.Coin()) curves[i] = Reversed(curves[i]);
    }
    const NurbsCurve<3> chain = Unified(curves, kIterated);
    EXPECT_EQ(chain.basis().degree(), 3);
    EXPECT_LE((chain.At(chain.basis().lower()) - Eigen::Vector3d(0, 0, 0)).norm(), kRounding);
    const CurveFootPoints<3> on_chain(chain);
    for (const NurbsCurve<3>& piece : originals) {
      for (int i = 0; i <= 40; ++i) {
        const double u =
            piece.basis().lower() + i / 40.0 * (piece.basis().upper() - piece.basis().lower());
        EXPECT_LE(on_chain.Nearest(piece.At(u)).distance, kRounding * 10);
      }
    }
    const std::vector<CurvePieceShape> pieces = PieceShapes(chain);
    std::vector<std::string> names;
    for (const CurvePieceShape& piece : pieces) names.push_back(NameOf(piece.shape));
    EXPECT_THAT(names, testing::ElementsAre("line", "circle", "free", "parabola"));
    EXPECT_NEAR(std::get<CircleShape>(pieces[1].shape).radius, 2, kIterated);
    EXPECT_EQ(chain.basis().Multiplicity(pieces[1].lower), 3);
  }
}

TEST(CurveChainTest, GapsAreClosedWithinTheToleranceOrSaid) {
  const NurbsCurve<2> a = MakeLine<2>({0, 0}, {1, 0}), b = MakeLine<2>({1, 0.01}, {1, 1}),
                      c = MakeLine<2>({1, 1}, {0.01, 0});
  EXPECT_THAT(RefusalOf([&] {
                Unified<2>({a, b}, 0.001);
              }),
              HasSubstr("the nearest, curve 2, is 0.01 from an end"));
  EXPECT_THAT(RefusalOf([&] {
                Unified<2>({a, b}, 0.001, {"a.json", "b.json"});
              }),
              HasSubstr("the nearest, b.json, is 0.01"));
  const NurbsCurve<2> open = Unified<2>({a, b}, 0.02);
  EXPECT_NEAR(open.At(1)[1], 0.005, kRounding);
  const NurbsCurve<2> closed = Unified<2>({a, b, c}, 0.02);
  EXPECT_EQ(closed.At(closed.basis().lower()), closed.At(closed.basis().upper()));
  EXPECT_THAT(RefusalOf([&] { Unified<2>({}, 0.02); }), HasSubstr("no curve"));
  EXPECT_THAT(RefusalOf([&] { Unified<2>({a, b}, -1); }), HasSubstr("tolerance"));
  EXPECT_THAT(RefusalOf([&] {
                Unified<2>({MakeArc(Eigen::Vector2d(0, 0), 1), a}, 1);
              }),
              HasSubstr("closed"));
  EXPECT_EQ(Unified<2>({a}, 0).basis().degree(), 3);
}

TEST(CurveChainTest, EverySpanOfDegreeTwoIsAPiece) {
  const NurbsCurve<2> circle = MakeArc(Eigen::Vector2d(1, 2), 3);
  EXPECT_EQ(PieceShapes(circle).size(), 4u);
  RandomSplines random(72);
  for (const CurvePieceShape& piece : PieceShapes(random.Curve<2>(2, false, {.most_spans = 4}))) {
    EXPECT_THAT(NameOf(piece.shape), testing::AnyOf("parabola", "line"));
  }
}

}  // namespace batten::internal::curve_chain_test
