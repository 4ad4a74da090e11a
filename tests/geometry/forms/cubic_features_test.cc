// SPDX-License-Identifier: MIT
#include "batten/geometry/cubic_features.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "batten/geometry/curvature.h"
#include "batten/geometry/degree_elevation.h"
#include "batten/geometry/insert_knots.h"
#include "batten/geometry/make_curve.h"
#include "batten/geometry/reparameterize.h"
#include "random_splines.h"
#include "refusal.h"
#include "tolerances.h"

namespace batten::internal::cubic_features_test {

NurbsCurve<2> Cubic(std::initializer_list<double> xy, const Eigen::VectorXd& weights = {}) {
  const std::vector<double> numbers(xy);
  const double ends[] = {0, 1};
  return NurbsCurve<2>(SplineBasis::Clamped(3, ends),
                       Eigen::Map<const Eigen::Matrix2Xd>(numbers.data(), 2, 4),
                       weights);
}

double Turn(const NurbsCurve<2>& curve, double u) {
  const CurveJet<2> jet = curve.JetAt(u);
  return jet.first[0] * jet.second[1] - jet.first[1] * jet.second[0];
}

// By samples: where the curvature changes sign.
std::vector<double> BruteInflections(const NurbsCurve<2>& curve,
                                     double lower,
                                     double upper,
                                     int samples) {
  std::vector<double> found;
  for (int k = 0; k < samples; ++k) {
    const double a = lower + (upper - lower) * (k + 0.5) / (samples + 1),
                 b = a + (upper - lower) / (samples + 1);
    if (Turn(curve, a) * Turn(curve, b) < 0) found.push_back((a + b) / 2);
  }
  return found;
}

// By samples: whether two legs of the polyline cross.
bool BruteCrosses(const NurbsCurve<2>& curve, double lower, double upper, int samples) {
  std::vector<Eigen::Vector2d> p;
  for (int k = 0; k <= samples; ++k) {
    p.push_back(
        curve.At(std::min(lower + (upper - lower) * k / samples, std::nextafter(upper, lower))));
  }
  const auto side = [&](size_t a, size_t b, size_t c) {
    const Eigen::Vector2d u = p[b] - p[a], v = p[c] - p[a];
    return u[0] * v[1] - u[1] * v[0];
  };
  for (size_t i = 0; i + 1 < p.size(); ++i) {
    for (size_t j = i + 2; j + 1 < p.size(); ++j) {
      if (side(i, i + 1, j) * side(i, i + 1, j + 1) < 0 &&
          side(j, j + 1, i) * side(j, j + 1, i + 1) < 0)
        return true;
    }
  }
  return false;
}

void ExpectAsByBruteForce(const NurbsCurve<2>& curve, int& loops, int& inflections) {
  constexpr int kInflectionSamples = 3000, kSamples = 300;
  for (const CubicFeatures& piece : FeaturesOfCubic(curve)) {
    const double length = piece.upper - piece.lower;
    const std::vector<double> brute =
        BruteInflections(curve, piece.lower, piece.upper, kInflectionSamples);
    // Two inflections within a step, or one at an end, are not seen by samples.
    std::vector<double> inner;
    for (const double u : piece.inflections) {
      const double step = length / kInflectionSamples;
      if (u > piece.lower + 2 * step && u < piece.upper - 2 * step) inner.push_back(u);
    }
    const bool close = std::adjacent_find(inner.begin(), inner.end(), [&](double a, double b) {
                         return b - a < 2 * length / kInflectionSamples;
                       }) != inner.end();
    if (!close && brute.size() == inner.size()) {
      for (size_t k = 0; k < inner.size(); ++k) EXPECT_NEAR(inner[k], brute[k], length / 1000);
    } else if (!close) {
      EXPECT_EQ(brute.size(), piece.inflections.size());
    }
    inflections += static_cast<int>(inner.size());
    const bool crosses = BruteCrosses(curve, piece.lower, piece.upper, kSamples);
    if (piece.loop) {
      EXPECT_LE((curve.At((*piece.loop)[0]) - curve.At((*piece.loop)[1])).norm(),
                kIterated * SizeOf(curve));
      EXPECT_TRUE(crosses || (*piece.loop)[1] - (*piece.loop)[0] < 0.05 * length);
      ++loops;
    } else {
      EXPECT_FALSE(crosses);
    }
  }
}

TEST(CubicFeaturesTest, InflectionsAndLoopsAreThoseThatSamplesShow) {
  RandomSplines random(41);
  int loops = 0, inflections = 0;
  for (int k = 0; k < 150; ++k) {
    SCOPED_TRACE(k);
    const bool rational = k % 2 == 1;
    NurbsCurve<2> curve = random.Curve<2>(3, false, {.clamped = random.Coin(), .most_spans = 3});
    if (rational)
      curve = NurbsCurve<2>(
          curve.basis(), curve.control_points(), random.Weights(curve.basis().size(), 0.3, 3));
    ExpectAsByBruteForce(curve, loops, inflections);
  }
  EXPECT_GT(loops, 3);
  EXPECT_GT(inflections, 30);
}

TEST(CubicFeaturesTest, AWideCrossingIsALoop) {
  const CubicFeatures loop = FeaturesOfCubic(Cubic({0, 0, 3, 2, -2, 2, 1, 0}))[0];
  EXPECT_EQ(NameOf(loop.kind), "loop");
  EXPECT_NEAR((*loop.loop)[0] + (*loop.loop)[1], 1, kRounding);  // symmetric
}

// Moving one control point of (0,0) (1,1) (0,1) (1,0) towards it: the cusp is where its polygon is
// the cross of diagonals.
TEST(CubicFeaturesTest, CuspsAreFound) {
  const CubicFeatures cusp = FeaturesOfCubic(Cubic({0, 0, 1, 1, 0, 1, 1, 0}))[0];
  EXPECT_EQ(NameOf(cusp.kind), "cusp");
  EXPECT_NEAR(*cusp.cusp, 0.5, kRounding);
  EXPECT_TRUE(cusp.inflections.empty());
  EXPECT_FALSE(cusp.loop);
  RandomSplines random(42);
  for (int k = 0; k < 50; ++k) {  // x'(t) and y'(t) with a common root
    const double at = random.Real(0.1, 0.9), a = random.Real(-2, 3), b = random.Real(-2, 3);
    // 3 Bernstein coefficients of (t − at)(t − a) are at·a, at·a − (at + a)/2, (1 − at)(1 − a).
    const auto legs = [&](double other) {
      return Eigen::Vector3d(at * other, at * other - (at + other) / 2, (1 - at) * (1 - other));
    };
    Eigen::Matrix2Xd points = Eigen::Matrix2Xd::Zero(2, 4);
    for (int i = 0; i < 3; ++i)
      points.col(i + 1) = points.col(i) + Eigen::Vector2d(legs(a)[i], legs(b)[i]);
    if (std::abs(a - b) < 0.2) continue;
    const double ends[] = {0, 1};
    const auto features = FeaturesOfCubic(NurbsCurve<2>(SplineBasis::Clamped(3, ends), points))[0];
    EXPECT_EQ(NameOf(features.kind), "cusp") << k;
    EXPECT_NEAR(features.cusp.value_or(-1), at, kIterated);
  }
}

TEST(CubicFeaturesTest, FormsOfLowerDegreeAreNamed) {
  EXPECT_EQ(NameOf(FeaturesOfCubic(Cubic({0, 0, 1, 1, 2, 2, 3, 3}))[0].kind), "line");
  EXPECT_EQ(NameOf(FeaturesOfCubic(Cubic({0, 0, 0, 1, 2, 1.5, 3, 0}))[0].kind), "arch");
  const auto circle = FeaturesOfCubic(Elevated(MakeArc(Eigen::Vector2d(1, 2), 3), 1));
  EXPECT_EQ(circle.size(), 4u);
  for (const CubicFeatures& piece : circle) EXPECT_EQ(NameOf(piece.kind), "conic");
}

// The features are the curve's own: they stay where they are under knots and Möbius maps.
TEST(CubicFeaturesTest, FeaturesFollowTheParameter) {
  RandomSplines random(43);
  for (int k = 0; k < 50; ++k) {
    const NurbsCurve<2> curve = random.Curve<2>(3, false, {.most_spans = 1});
    const CubicFeatures plain = FeaturesOfCubic(curve)[0];
    const NurbsCurve<2> moved = WithEndWeights(curve, 1, 2.5);
    const CubicFeatures other = FeaturesOfCubic(moved)[0];
    ASSERT_EQ(plain.inflections.size(), other.inflections.size());
    ASSERT_EQ(plain.loop.has_value(), other.loop.has_value());
    for (size_t i = 0; i < plain.inflections.size(); ++i) {
      EXPECT_LE((curve.At(plain.inflections[i]) - moved.At(other.inflections[i])).norm(),
                kHalfDigits);
    }
    if (plain.loop) {
      EXPECT_LE((curve.At((*plain.loop)[0]) - moved.At((*other.loop)[0])).norm(), kHalfDigits);
    }
  }
}

NurbsCurve<3> WithModestWeights(const NurbsCurve<3>& curve, bool rational, RandomSplines& random) {
  if (!rational) return curve;
  return NurbsCurve<3>(
      curve.basis(), curve.control_points(), random.Weights(curve.basis().size(), 0.3, 3));
}

// A cubic in no plane has torsion of one sign, between the extremes said.
TEST(CubicFeaturesTest, TorsionIsBounded) {
  RandomSplines random(44);
  for (int k = 0; k < 40; ++k) {
    SCOPED_TRACE(k);
    const NurbsCurve<3> curve =
        WithModestWeights(random.Curve<3>(3, false, {.most_spans = 2}), k % 2 == 1, random);
    for (const CubicFeatures& piece : FeaturesOfCubic(curve)) {
      ASSERT_EQ(NameOf(piece.kind), "space");
      const auto [low, high] = *piece.torsion;
      EXPECT_GT(low * high, 0);
      for (int i = 0; i < 200; ++i) {
        const double u = random.Real(piece.lower, piece.upper), t = CurvatureAt(curve, u)->torsion;
        EXPECT_GE(t, low - kHalfDigits * std::abs(low) * 100);
        EXPECT_LE(t, high + kHalfDigits * std::abs(high) * 100);
      }
    }
  }
}

TEST(CubicFeaturesTest, OtherDegreesAreRefused) {
  RandomSplines random(45);
  EXPECT_NE(RefusalOf([&] { FeaturesOfCubic(random.Curve<2>(4, false)); }), "accepted");
  EXPECT_NE(RefusalOf([&] { FeaturesOfCubic(random.Curve<2>(3, false), 0); }), "accepted");
}

}  // namespace batten::internal::cubic_features_test
