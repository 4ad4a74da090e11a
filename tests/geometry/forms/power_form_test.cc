// SPDX-License-Identifier: MIT
#include "batten/geometry/power_form.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "batten/geometry/clamp.h"
#include "random_splines.h"
#include "refusal.h"
#include "tolerances.h"

namespace batten::internal::power_form_test {

using ::testing::HasSubstr;

constexpr int kHighest = 9;  // 3^9 roundings are within kIterated

TEST(PowerFormTest, PowersAreTheCurveAndComeBack) {
  RandomSplines random(11);
  for (int k = 0; k < 300; ++k) {
    SCOPED_TRACE(k);
    const int degree = random.Integer(1, kHighest);
    BasisKind kind{.clamped = random.Coin(), .periodic = random.Integer(0, 3) == 0};
    NurbsCurve<3> curve = random.Curve<3>(degree, false, kind);
    if (random.Coin()) {
      Eigen::VectorXd weights = random.Weights(curve.basis().size(), 0.3, 3);
      if (curve.basis().periodic()) weights.setOnes();
      curve = NurbsCurve<3>(curve.basis(), curve.control_points(), weights);
    }
    const PowerCurve<3> power = ToPower(curve);
    const NurbsCurve<3> back = FromPower(power);
    for (int i = 0; i < 50; ++i) {
      const double u = random.Parameter(curve.basis());
      EXPECT_LE((power.At(u) - curve.At(u)).norm(), kIterated);
      EXPECT_LE((back.At(u) - curve.At(u)).norm(), kIterated);
    }
    EXPECT_EQ(back.basis().lower(), curve.basis().lower());
    EXPECT_EQ(back.basis().upper(), curve.basis().upper());
    EXPECT_EQ(back.rational(), curve.rational());
  }
}

// t ↦ (1 + 2t − t³, t², 5): its coefficients.
TEST(PowerFormTest, CoefficientsAreThoseOfThePolynomial) {
  PowerCurve<3> power;
  power.degree = 3;
  power.breaks = {2, 4};
  power.coefficients.resize(4, 4);
  power.coefficients << 1, 2, 0, -1, 0, 0, 1, 0, 5, 0, 0, 0, 1, 0, 0, 0;
  const NurbsCurve<3> curve = FromPower(power);
  for (const double t : {0.0, 0.3, 0.5, 1.0}) {
    const Eigen::Vector3d expected(1 + 2 * t - t * t * t, t * t, 5);
    EXPECT_LE((curve.At(2 + 2 * t) - expected).norm(), kRounding);
    EXPECT_LE((power.At(2 + 2 * t) - expected).norm(), kRounding);
  }
  EXPECT_LE((ToPower(curve).coefficients - power.coefficients).cwiseAbs().maxCoeff(), kRounding);
}

TEST(PowerFormTest, SurfacesToo) {
  RandomSplines random(12);
  for (int k = 0; k < 60; ++k) {
    SCOPED_TRACE(k);
    const BasisKind u{.clamped = random.Coin(), .most_spans = 3}, v{.most_spans = 2};
    NurbsSurface surface = random.Surface(random.Integer(1, 5), random.Integer(1, 5), false, u, v);
    if (random.Coin()) {
      surface = NurbsSurface(surface.basis_u(),
                             surface.basis_v(),
                             surface.control_points(),
                             random.Weights(surface.control_points().cols(), 0.3, 3));
    }
    const PowerSurface power = ToPower(surface);
    const NurbsSurface back = FromPower(power);
    for (int i = 0; i < 50; ++i) {
      const double s = random.Parameter(surface.basis_u()), t = random.Parameter(surface.basis_v());
      EXPECT_LE((power.At(s, t) - surface.At(s, t)).norm(), kIterated);
      EXPECT_LE((back.At(s, t) - surface.At(s, t)).norm(), kIterated);
    }
  }
}

TEST(PowerFormTest, FarAwayAndTinyShapesKeepTheirDigits) {
  RandomSplines random(13);
  const NurbsCurve<3> curve = random.Curve<3>(5, false);
  for (const auto& [shift, scale] : {std::pair{5e6, 1.0}, {0.0, 1e-6}, {0.0, 1e9}}) {
    Eigen::Matrix3Xd points = scale * curve.control_points();
    points.array() += shift;
    const NurbsCurve<3> moved(curve.basis(), points);
    const NurbsCurve<3> back = FromPower(ToPower(moved));
    for (int i = 0; i < 50; ++i) {
      const double u = random.Parameter(curve.basis());
      EXPECT_LE((back.At(u) - moved.At(u)).norm(), kRounding * 100 * (shift * 1e-3 + scale));
    }
  }
}

// The loss grows by about three with every degree, and is said.
TEST(PowerFormTest, HighDegreesAreRefusedWithTheLossMeasured) {
  RandomSplines random(14);
  const NurbsCurve<2> high = random.Curve<2>(25, false, {.most_spans = 1});
  EXPECT_THAT(RefusalOf([&] { ToPower(high); }),
              HasSubstr("powers of degree 25 lose the shape by"));
  const NurbsCurve<2> low = random.Curve<2>(10, false, {.most_spans = 1});
  EXPECT_EQ(RefusalOf([&] { ToPower(low); }), "accepted");
  EXPECT_THAT(RefusalOf([&] { ToPower(low, 1e-16); }),
              testing::AnyOf(HasSubstr("lose"), HasSubstr("accepted")));
}

TEST(PowerFormTest, BrokenFormsAreRefused) {
  PowerCurve<2> power;
  power.degree = 1;
  power.breaks = {0, 1, 2};
  power.coefficients.resize(3, 4);
  power.coefficients << 0, 1, 1.5, 1, 0, 0, 0, 0, 1, 0, 1, 0;
  EXPECT_THAT(RefusalOf([&] { FromPower(power); }), HasSubstr("0.5 apart"));
  power.coefficients(0, 2) = 1;
  EXPECT_EQ(RefusalOf([&] { FromPower(power); }), "accepted");
  power.coefficients(2, 0) = -1;
  EXPECT_NE(RefusalOf([&] { FromPower(power); }), "accepted");
  power.coefficients(0, 0) = NAN;
  EXPECT_THAT(RefusalOf([&] { FromPower(power); }), HasSubstr("not finite"));
  power.breaks = {0, 1, 1};
  EXPECT_THAT(RefusalOf([&] { FromPower(power); }), HasSubstr("does not increase"));
  power.breaks = {0, 1};
  EXPECT_THAT(RefusalOf([&] { FromPower(power); }), HasSubstr("coefficients"));
  power.degree = 0;
  EXPECT_THAT(RefusalOf([&] { FromPower(power); }), HasSubstr("degree"));
}

}  // namespace batten::internal::power_form_test
