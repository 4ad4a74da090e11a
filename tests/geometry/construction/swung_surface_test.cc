// SPDX-License-Identifier: MIT
#include "batten/geometry/swung_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "batten/geometry/bezier_surface.h"
#include "batten/geometry/make_curve.h"
#include "batten/geometry/make_surface.h"
#include "construction_cases.h"
#include "refusal.h"
#include "tolerances.h"

namespace batten::internal::swung_surface_test {

using ::testing::HasSubstr;

TEST(SweepTranslationalTest, IsTheSumOfItsCurvesAndHasNoTwist) {
  for (int seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const bool rational = random.Coin();
    const auto a = random.Curve<3>(random.Integer(1, 5), rational, {.periodic = random.Coin()});
    const auto b = random.Curve<3>(random.Integer(1, 5), random.Coin());
    if ((a.control_points().colwise() - a.control_points().col(0)).isZero(0)) {
      EXPECT_THAT(RefusalOf([&] { SweepTranslational(a, b); }), HasSubstr("profile is a point"));
      continue;
    }
    const NurbsSurface surface = SweepTranslational(a, b);
    const Eigen::Vector3d start = b.At(b.basis().lower());
    for (int k = 0; k < 10; ++k) {
      const double u = random.Parameter(a.basis()), v = random.Parameter(b.basis());
      EXPECT_LE((surface.At(u, v) - (a.At(u) + b.At(v) - start)).norm(), 10 * kRounding);
    }
  }
  RandomSplines random(1);
  const auto a = random.Curve<3>(3, false, {.most_spans = 1}),
             b = random.Curve<3>(4, false, {.most_spans = 1});
  EXPECT_LE(ControlTwists(ToBezier(SweepTranslational(a, b))).norm(), 100 * kRounding);
}

TEST(SwingTest, IsItsFormula) {
  for (int seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    auto flat = [&](int row) {
      NurbsCurve<3> curve = random.Curve<3>(random.Integer(1, 4), random.Coin());
      Eigen::Matrix3Xd points = curve.control_points();
      points.row(row).setZero();
      return NurbsCurve<3>(curve.basis(), points, curve.weights());
    };
    NurbsCurve<3> profile = flat(1);
    const NurbsCurve<3> path = flat(2);
    Eigen::Matrix3Xd one_side = profile.control_points();
    one_side.row(0) = one_side.row(0).cwiseAbs();
    profile = NurbsCurve<3>(profile.basis(), one_side, profile.weights());
    const Frame frame(random.Vector(3), random.Vector(1));
    Eigen::Matrix4d place = Eigen::Matrix4d::Identity();
    place.topRows<3>() << frame.x(), frame.y(), frame.axis(), frame.origin();
    const NurbsSurface surface =
        Swing(Transformed(profile, place), Transformed(path, place), frame, 1.7);
    for (int k = 0; k < 10; ++k) {
      const double u = random.Parameter(path.basis()), v = random.Parameter(profile.basis());
      const Eigen::Vector3d p = profile.At(v), t = path.At(u);
      const Eigen::Vector3d expected = frame.At(1.7 * p.x() * t.x(), 1.7 * p.x() * t.y(), p.z());
      EXPECT_LE((surface.At(u, v) - expected).norm(), 100 * kRounding);
    }
  }
}

TEST(SwingTest, RoundACircleItIsTheSurfaceOfRevolution) {
  const NurbsCurve<3> profile = Cubic({{2, 0, 0}, {3, 0, 1}, {1, 0, 2}, {2, 0, 3}});
  EXPECT_LE(LargestDifference(Swing(profile, MakeArc(Frame(), 1)), Revolve(profile, Frame())),
            100 * kRounding);
  EXPECT_THAT(RefusalOf([&] {
                Swing(Cubic({{2, 0, 0}, {3, 0.5, 1}, {1, 0, 2}, {2, 0, 3}}), MakeArc(Frame(), 1));
              }),
              HasSubstr("the profile leaves the plane of the x axis and the axis by 0.5"));
  EXPECT_THAT(RefusalOf([&] {
                Swing(profile, MakeArc(Frame({0, 0, 1}, {0, 0, 1}), 1));
              }),
              HasSubstr("the trajectory leaves the plane of the x axis and the y axis by 1"));
  EXPECT_THAT(RefusalOf([&] { Swing(profile, MakeArc(Frame(), 1), Frame(), 0); }),
              HasSubstr("scale"));
}

TEST(SwingTest, AProfileOnBothSidesOfTheAxisIsRefusedWhereBothSweepTheSame) {
  const NurbsCurve<3> profile(
      SplineBasis::Uniform(2, 5, 0, 1),
      Eigen::Matrix3Xd{{1, -1, -1, -1, 1}, {0, 0, 0, 0, 0}, {0, 1, 2, 3, 4}});
  EXPECT_THAT(RefusalOf([&] { Swing(profile, MakeArc(Frame(), 1)); }),
              HasSubstr("Swing: the profile crosses its axis 2 times"));
  EXPECT_EQ(Swing(profile, MakeArc(Frame(), 1, {0, std::numbers::pi})).size_v(), 5);
}

}  // namespace batten::internal::swung_surface_test
