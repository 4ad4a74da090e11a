// SPDX-License-Identifier: MIT
#include "batten/geometry/conic_arc.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "angles.h"
#include "batten/geometry/classify_shape.h"
#include "batten/geometry/foot_point.h"
#include "batten/geometry/make_curve.h"
#include "distance_in_ulps.h"
#include "random_splines.h"
#include "refusal.h"
#include "tolerances.h"

namespace batten::internal::conic_arc_test {

using ::testing::HasSubstr;

template <int Dim>
ConicArc<Dim> RandomArc(RandomSplines& random, double w1) {
  ConicArc<Dim> arc;
  const double weights[] = {random.Logarithmic(0.1, 10), w1, random.Logarithmic(0.1, 10)};
  for (int i = 0; i < 3; ++i) {
    arc.columns.col(i) << weights[i] * random.Vector(1).head<Dim>(), weights[i];
  }
  return arc;
}

// Every piece of the curve lies on the arc's conic, ends where the arc does and goes the same way.
TEST(ConicArcTest, CurvesAreTheArcWhateverTheMiddleWeight) {
  RandomSplines random(5);
  for (int k = 0; k < 400; ++k) {
    SCOPED_TRACE(k);
    ConicArc<3> arc = RandomArc<3>(random, 1);
    const double least = -0.95 * std::sqrt(arc.columns(3, 0) * arc.columns(3, 2));
    arc.columns.col(1) << random.Vector(2), random.Integer(0, 4) == 0 ? 0 : random.Real(least, 3);
    const NurbsCurve<3> curve = ToNurbs(arc);
    EXPECT_GT(curve.weights().minCoeff(), 0);
    EXPECT_LE(curve.basis().size(), 9);
    const double size = curve.control_points().cwiseAbs().maxCoeff();
    EXPECT_LE((curve.At(0) - arc.At(0)).norm(), kRounding * size);
    EXPECT_LE((curve.At(1) - arc.At(1)).norm(), kRounding * size);
    EXPECT_LE((curve.At(0.5) - arc.Standard().At(0.5)).norm(), kIterated * size);
    const CurveFootPoints<3> feet(curve);
    for (int i = 1; i < 20; ++i) {
      EXPECT_LE(feet.Nearest(arc.At(i / 20.0)).distance, kIterated * size);
    }
  }
}

TEST(ConicArcTest, ArcsThroughInfinityAndInfiniteEndsAreRefused) {
  ConicArc<2> arc;
  arc.columns << 0, 1, 2, 0, -1, 0, 1, -1.5, 1;
  EXPECT_THAT(RefusalOf([&] { ToNurbs(arc); }), HasSubstr("through infinity"));
  arc.columns(2, 2) = 0;
  EXPECT_THAT(RefusalOf([&] { ToNurbs(arc); }), HasSubstr("an end at infinity"));
  arc.columns(2, 2) = -1;
  EXPECT_THAT(RefusalOf([&] { ToNurbs(arc); }), HasSubstr("one sign"));
}

TEST(ConicArcTest, TheArcMeetsEndsTangentsAndPoint) {
  RandomSplines random(6);
  for (int k = 0; k < 500; ++k) {
    SCOPED_TRACE(k);
    const Eigen::Vector3d shift = random.Coin() ? random.Vector(5e6) : Eigen::Vector3d(0, 0, 0);
    const Eigen::Vector3d start = random.Vector(1), end = random.Vector(1), pole = random.Vector(1);
    if ((end - start).cross(pole - start).norm() < 0.05) continue;
    const double s = random.Real(0.05, 0.6), t = random.Real(0.05, 0.35);
    const Eigen::Vector3d point = s * start + t * end + (1 - s - t) * pole;
    // Far away the coordinates are rounded to 1e-9, and the conic is as good as those.
    const double allowed = shift.norm() > 0 ? kHalfDigits : kIterated;
    const ConicArc<3> arc = ConicArcThrough<3>(start + shift,
                                               pole - start,
                                               end + shift,
                                               (random.Coin() ? 1 : -2) * (end - pole),
                                               point + shift);
    const NurbsCurve<3> curve = ToNurbs(arc);
    EXPECT_LE((curve.At(0) - start - shift).norm(), allowed);
    EXPECT_LE((curve.At(1) - end - shift).norm(), allowed);
    EXPECT_LE(curve.JetAt(0).first.normalized().cross((pole - start).normalized()).norm(), allowed);
    EXPECT_LE(curve.JetAt(1).first.normalized().cross((pole - end).normalized()).norm(), allowed);
    EXPECT_LE(CurveFootPoints<3>(curve).Nearest(point + shift).distance, allowed);
  }
}

TEST(ConicArcTest, ParallelTangentsGiveHalfAnEllipse) {
  for (const Eigen::Vector2d& point : {Eigen::Vector2d(0, 1), Eigen::Vector2d(0.6, -0.8)}) {
    const ConicArc<2> arc = ConicArcThrough<2>({1, 0}, {0, 1}, {-1, 0}, {0, -1}, point);
    EXPECT_EQ(arc.columns(2, 1), 0);
    EXPECT_EQ(arc.ShapeFactor(), HUGE_VAL);
    const NurbsCurve<2> curve = ToNurbs(arc);
    EXPECT_EQ(curve.basis().size(), 5);
    for (int k = 0; k <= 100; ++k) EXPECT_NEAR(curve.At(k / 100.0).norm(), 1, kRounding);
    EXPECT_GT(curve.At(0.5)[1] * point[1], 0);
  }
  const NurbsCurve<2> half = ToNurbs(ConicArcOfShoulder<2>({2, 0}, {0, 1}, {-2, 0}, 0));
  EXPECT_NEAR(std::get<EllipseShape>(ClassifyShape(half)).major_radius, 2, kIterated);
}

TEST(ConicArcTest, RhoPlacesTheShoulderAndChoosesTheKind) {
  const Eigen::Vector2d start(0, 0), pole(1, 2), end(3, 0);
  for (const double rho : {0.1, 0.3, 0.5, 0.7, 0.95}) {
    const ConicArc<2> arc = ConicArcOfRho<2>(start, pole - start, end, end - pole, rho);
    const Eigen::Vector2d middle = (start + end) / 2, shoulder = middle + rho * (pole - middle);
    EXPECT_LE((arc.At(0.5) - shoulder).norm(), kRounding);
    EXPECT_EQ(NameOf(ClassifyShape(ToNurbs(arc))),
              rho < 0.5   ? "ellipse"
              : rho > 0.5 ? "hyperbola"
                          : "parabola");
    EXPECT_EQ(arc.ShapeFactor() > 1 + kRounding, rho < 0.5);
    const ConicArc<2> same = ConicArcOfShoulder<2>(start, shoulder, end, rho);
    EXPECT_LE((same.columns - arc.columns).cwiseAbs().maxCoeff(), kRounding * 30);
  }
  EXPECT_THAT(RefusalOf([&] {
                ConicArcOfRho<2>(start, {0, 1}, end, {0, -1}, 0.4);
              }),
              HasSubstr("parallel"));
  EXPECT_THAT(RefusalOf([&] { ConicArcOfRho<2>(start, pole, end, pole - end, 1); }),
              HasSubstr("(0, 1)"));
  EXPECT_THAT(RefusalOf([&] {
                ConicArcOfRho<2>(start, {1, 0}, end, pole - end, 0.5);
              }),
              HasSubstr("along the chord"));
  EXPECT_THAT(RefusalOf([&] {
                ConicArcOfRho<3>({0, 0, 0}, {1, 1, 0}, {2, 0, 0}, {-1, 1, 0.1}, 0.5);
              }),
              HasSubstr("miss each other by"));
}

TEST(ConicArcTest, FivePointsOfAnArcGiveItBack) {
  RandomSplines random(7);
  int proper = 0;
  for (int k = 0; k < 400; ++k) {
    SCOPED_TRACE(k);
    ConicArc<3> arc = RandomArc<3>(random, 1);
    arc.columns.col(1) *= random.Logarithmic(0.2, 4);
    Eigen::Matrix<double, 3, 5> points;
    for (int i = 0; i < 5; ++i) points.col(i) = arc.Standard().At(0.02 + 0.24 * i);
    const double size = (points.colwise() - points.col(0)).norm();
    const Eigen::Vector3d bend =
        (points.col(4) - points.col(0)).cross(points.col(2) - points.col(0));
    if (!(bend.norm() > 0.05 * size * size)) continue;
    ++proper;
    const NurbsCurve<3> curve = ToNurbs(ConicArcThroughFive<3>(points));
    const CurveFootPoints<3> feet(curve);
    for (int i = 0; i < 5; ++i)
      EXPECT_LE(feet.Nearest(points.col(i)).distance, kHalfDigits * 1e-2 * size);
    for (int i = 0; i <= 20; ++i) {
      EXPECT_LE(feet.Nearest(arc.Standard().At(0.02 + 0.048 * i)).distance, kHalfDigits * size);
    }
  }
  EXPECT_GT(proper, 100);
}

TEST(ConicArcTest, FiveBadPointsAreRefused) {
  Eigen::Matrix<double, 2, 5> points;
  points << 0, 1, 2, 3, 5, 0, 1, 2, 5, 1;
  EXPECT_THAT(RefusalOf([&] { ConicArcThroughFive<2>(points); }),
              HasSubstr("points 1, 2 and 3 lie on one line"));
  points.col(1) = points.col(0);
  EXPECT_THAT(RefusalOf([&] { ConicArcThroughFive<2>(points); }),
              HasSubstr("points 1 and 2 coincide"));
  for (int i = 0; i < 5; ++i) {  // both branches of x y = 1
    const double x = i < 3 ? i + 1.0 : 2.0 - i;
    points.col(i) << x, 1 / x;
  }
  EXPECT_THAT(RefusalOf([&] { ConicArcThroughFive<2>(points); }), HasSubstr("branch"));
  Eigen::Matrix<double, 3, 5> bent = Eigen::Matrix<double, 3, 5>::Random();
  EXPECT_THAT(RefusalOf([&] { ConicArcThroughFive<3>(bent); }), HasSubstr("off their plane"));
  points(0, 0) = NAN;
  EXPECT_THAT(RefusalOf([&] { ConicArcThroughFive<2>(points); }), HasSubstr("not finite"));
}

// Equation of an arc, and an arc of the equation between its ends through its middle.
TEST(ConicArcTest, EquationsAndArcsAreInverse) {
  RandomSplines random(8);
  for (int k = 0; k < 400; ++k) {
    SCOPED_TRACE(k);
    ConicArc<2> arc = RandomArc<2>(random, 1);
    const double scale = std::sqrt(arc.columns(2, 0) * arc.columns(2, 2));
    arc.columns.col(1) *=
        (random.Integer(0, 3) == 0 ? -0.6 : 1) * random.Logarithmic(0.3, 1.5) * scale;
    const ConicArc<2> standard = arc.Standard();
    const Eigen::Vector2d a = standard.At(0),
                          b = standard.columns.col(1).head<2>() / standard.columns(2, 1),
                          c = standard.At(1);
    const double area = std::abs((b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0]);
    if (area < 0.1 || standard.columns(2, 1) < -0.95) continue;
    const ImplicitConic conic = ImplicitOf(arc);
    for (int i = 0; i <= 20; ++i) {
      const Eigen::Vector2d p = standard.At(i / 20.0);
      EXPECT_LE(std::abs(conic.At(p)), kRounding * 1000 * std::max(1.0, p.squaredNorm()));
    }
    const ConicArc<2> back = ArcOf(conic, a, c, standard.At(0.5));
    EXPECT_LE((back.columns - standard.columns).cwiseAbs().maxCoeff(), kHalfDigits);
  }
}

TEST(ConicArcTest, TheShorterArcUnlessVia) {
  const ImplicitConic circle{1, 0, 1, 0, 0, -1};
  const Eigen::Vector2d right(1, 0), top(0, 1), left(-1, 0);
  EXPECT_NEAR(ArcOf(circle, right, top).At(0.5)[0], std::sqrt(0.5), kRounding);
  EXPECT_NEAR(ArcOf(circle, right, top, left).At(0.5)[0], -std::sqrt(0.5), kRounding);
  EXPECT_NEAR(ArcOf(circle, right, left).At(0.5)[1], 1, kRounding);
  EXPECT_NEAR(ArcOf(circle, left, right).At(0.5)[1], -1, kRounding);
  EXPECT_NEAR(ArcOf(circle, left, right, top).At(0.5)[1], 1, kRounding);
}

TEST(ConicArcTest, WhatTheConicDoesNotHoldIsRefused) {
  const ImplicitConic hyperbola{1, 0, -1, 0, 0, -1};
  const double s2 = std::sqrt(2.0);
  EXPECT_THAT(RefusalOf([&] {
                ArcOf(hyperbola, {s2, 1}, {-s2, 1});
              }),
              HasSubstr("different branches"));
  EXPECT_THAT(RefusalOf([&] {
                ArcOf(hyperbola, {s2, 1}, {s2, -1}, Eigen::Vector2d(-1, 0));
              }),
              HasSubstr("infinity"));
  EXPECT_THAT(RefusalOf([&] { ArcOf(hyperbola, {1, 0.5}, {s2, 1}); }), HasSubstr("off the conic"));
  EXPECT_THAT(RefusalOf([&] {
                ArcOf({1, 0, -1, 0, 0, 0}, {1, 1}, {2, 2});
              }),
              HasSubstr("two crossing lines"));
  EXPECT_THAT(RefusalOf([&] { ArcOf({1, 0, 1, 0, 0, 1}, {1, 1}, {2, 2}); }), HasSubstr("empty"));
  EXPECT_THAT(RefusalOf([&] { ArcOf(hyperbola, {1, 0}, {1, 0}); }), HasSubstr("one point"));
}

}  // namespace batten::internal::conic_arc_test
