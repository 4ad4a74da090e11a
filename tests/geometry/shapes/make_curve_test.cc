// SPDX-License-Identifier: MIT
#include "batten/geometry/make_curve.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "batten/geometry/arc_length.h"
#include "batten/geometry/curve_evaluator.h"
#include "distance_in_ulps.h"
#include "fixtures.h"
#include "random_splines.h"
#include "tolerances.h"
#include "refusal.h"
#include "angles.h"

namespace batten::internal::make_curve_test {

using ::testing::HasSubstr;

constexpr unsigned kSeed = 71;
constexpr int kPlaces = 10000;

AngleRange RandomAngles(RandomSplines& random) {
  return {random.Coin() ? 0 : random.Real(-7, 7),
          random.Coin() ? 2 * kPi : random.Real(0.001, 2 * kPi)};
}

// Radii just below a power of two are the hardest: their last place is the finest for their size.
double RandomRadius(RandomSplines& random) {
  return random.Coin() ? std::nextafter(std::exp2(random.Integer(-9, 10)), 0)
                       : random.Logarithmic(1e-3, 1e3);
}

// The distances of points of the arc from its circle: by the curve itself, and half of those by its
// evaluator, which may round twice as much.
template <int Dim>
double WorstDistance(const NurbsCurve<Dim>& arc,
                     const Eigen::Vector3d& center,
                     double radius,
                     RandomSplines& random) {
  const CurveEvaluator<Dim> fast(arc);
  long double worst = 0;
  for (int k = 0; k < kPlaces; ++k) {
    const double u = random.Real(0, 1);
    const auto distance = [&](const auto& point) {
      return std::abs(ExtendedNorm(Extended(point) - Extended(center)) - radius);
    };
    worst = std::max({worst, distance(arc.At(u)), distance(fast.At(u)) / 2});
  }
  return static_cast<double>(worst);
}

void ExpectCirclesAreExact(unsigned seed, int cases) {
  RandomSplines random(seed);
  for (int k = 0; k < cases; ++k) {
    SCOPED_TRACE(testing::Message() << "seed " << seed << ", case " << k);
    const double radius = RandomRadius(random);
    const AngleRange angles = RandomAngles(random);
    const Eigen::Vector3d home(0, 0, 0), far = random.Vector(5e6);
    const double bound = 4 * Ulp(radius);
    EXPECT_LE(WorstDistance(MakeArc(Eigen::Vector2d(0, 0), radius, angles), home, radius, random),
              bound);
    const NurbsCurve<3> tilted =
        MakeArc(Frame(home, random.Vector(1), random.Vector(1)), radius, angles);
    EXPECT_LE(WorstDistance(tilted, home, radius, random), bound + 2 * Ulp(radius));
    const NurbsCurve<3> moved =
        MakeArc(Frame(far, random.Vector(1), random.Vector(1)), radius, angles);
    const double largest = moved.control_points().cwiseAbs().maxCoeff();
    EXPECT_LE(WorstDistance(moved, far, radius, random), bound + 2 * Ulp(largest));
  }
}

TEST(MakeCurveTest, CirclesAreExactToFourUnitsInTheLastPlace) { ExpectCirclesAreExact(kSeed, 10); }

// The same law for every form: three pieces, five degrees, arcs of one to four segments.
TEST(MakeCurveTest, EveryFormOfACircleIsExactToFourUnitsInTheLastPlace) {
  RandomSplines random(kSeed + 2);
  for (int k = 0; k < 10; ++k) {
    SCOPED_TRACE(k);
    const double radius = RandomRadius(random), start = random.Coin() ? 0 : random.Real(-7, 7);
    const Eigen::Vector3d home(0, 0, 0);
    const double bound = 4 * Ulp(radius);
    for (const CircleForm form :
         {CircleForm::kNinePoints, CircleForm::kSevenPoints, CircleForm::kDegreeFive}) {
      const NurbsCurve<3> circle = MakeCircle(Frame(), radius, form, start);
      EXPECT_GT(circle.weights().minCoeff(), 0);
      EXPECT_TRUE(circle.At(0) == circle.At(1));
      // Rounding follows the control points, which are up to 4.13 radii away in the last form.
      const double wide = form == CircleForm::kDegreeFive ? 4 * Ulp(4.13 * radius) : bound;
      EXPECT_LE(WorstDistance(circle, home, radius, random), wide) << static_cast<int>(form);
    }
    for (int pieces = 1; pieces <= 4; ++pieces) {
      const double sweep = std::min(2 * kPi, random.Real(0.01, 2.1) * pieces);
      const NurbsCurve<3> arc = MakeArc(Frame(), radius, {start, sweep}, pieces);
      EXPECT_EQ(arc.basis().size(), 2 * pieces + 1);
      EXPECT_LE(WorstDistance(arc, home, radius, random), bound) << pieces;
    }
  }
  EXPECT_THAT(RefusalOf([] { MakeArc(Frame(), 1, {0, 4}, 1); }), HasSubstr("180 degrees"));
  EXPECT_THAT(RefusalOf([] { MakeArc(Frame(), 1, {0, 4}, 0); }), HasSubstr("not in [1, 1000]"));
}

TEST(LongMakeCurveTest, ManyCirclesAreExactToFourUnitsInTheLastPlace) {
  ExpectCirclesAreExact(kSeed + 1, 500);
}

TEST(MakeCurveTest, FullCirclesCloseBitByBit) {
  RandomSplines random(kSeed);
  for (int k = 0; k < 50; ++k) {
    const NurbsCurve<3> circle = MakeArc(Frame(random.Vector(1e3), random.Vector(1)),
                                         random.Logarithmic(1e-3, 1e3),
                                         {random.Real(-10, 10), 2 * kPi});
    EXPECT_EQ(circle.basis().size(), 9);
    EXPECT_TRUE(circle.At(0) == circle.At(1));
  }
}

TEST(MakeCurveTest, QuarterTurnsAreExact) {
  const NurbsCurve<2> circle = MakeArc(Eigen::Vector2d(0, 0), 3);
  Eigen::Matrix2Xd expected(2, 9);
  expected << 3, 3, 0, -3, -3, -3, 0, 3, 3, 0, 3, 3, 3, 0, -3, -3, -3, 0;
  EXPECT_EQ(circle.control_points(), expected);
  const NurbsCurve<2> lower = MakeArc(Eigen::Vector2d(0, 0), 3, {-kPi / 2, kPi});
  EXPECT_EQ(lower.At(0), Eigen::Vector2d(0, -3));
  EXPECT_EQ(lower.At(1), Eigen::Vector2d(0, 3));
  EXPECT_EQ(lower.basis().size(), 5);
}

TEST(MakeCurveTest, ArcsBeginAndEndAtTheirAnglesAndTurnCounterClockwise) {
  RandomSplines random(kSeed);
  for (int k = 0; k < 200; ++k) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed << ", case " << k);
    const Frame frame(random.Vector(10), random.Vector(1), random.Vector(1));
    const double rx = random.Real(0.1, 5), ry = random.Real(0.1, 5);
    const AngleRange a = RandomAngles(random);
    const NurbsCurve<3> arc = MakeEllipseArc(frame, rx, ry, a);
    const auto at = [&](double t) { return frame.At(rx * std::cos(t), ry * std::sin(t), 0); };
    EXPECT_LE((arc.At(0) - at(a.start)).norm(), kRounding * 20);
    EXPECT_LE((arc.At(1) - at(a.start + a.sweep)).norm(), kRounding * 20);
    const Eigen::Vector3d forward =
        -rx * std::sin(a.start) * frame.x() + ry * std::cos(a.start) * frame.y();
    EXPECT_GT(arc.JetAt(0).first.normalized().dot(forward.normalized()), 1 - 1e-9);
  }
}

// The arc through its point is the arc about its centre; of a flat one the height is right to
// rounding of that height, which no centre could give.
TEST(MakeCurveTest, FlatArcsKeepTheirDigits) {
  const Eigen::Vector2d point(0, 0), outward(0, 1), forward(-1, 0);
  const NurbsCurve<2> arc = MakeFlatArc<2>(point, outward, forward, 2, {0.3, 4});
  const NurbsCurve<2> about = MakeArc(Eigen::Vector2d(0, -0.5), 0.5, {0.3 + kPi / 2, 4});
  EXPECT_LE((arc.control_points() - about.control_points()).cwiseAbs().maxCoeff(), kRounding);
  const double half = 1e-9;  // of a circle of radius 1e9: two units long
  const NurbsCurve<2> flat = MakeFlatArc<2>(point, outward, forward, 1e-9, {-half, 2 * half});
  const double height = -2e9 * std::pow(std::sin(half / 2), 2);
  EXPECT_NEAR(flat.At(0).y(), height, kRounding * std::abs(height));
  EXPECT_NEAR(flat.At(0.5).y(), 0, kRounding * std::abs(height));
}

TEST(MakeCurveTest, TheFixturesAreReproduced) {
  using namespace fixtures;
  int seen = 0;
  CheckAll("exact_primitives.json", [&](const Json& input, const Json& expected, double tolerance) {
    if (!expected.contains("length")) return;
    ++seen;
    const double rx = input.at("radii")[0], ry = input.at("radii")[1];
    const double start = input.at("angle_start"), end = input.at("angle_end");
    const NurbsCurve<3> curve = MakeEllipseArc(Frame(), rx, ry, {start, end - start});
    ExpectClose(ArcLength(curve), expected.at("length"), tolerance);
    ExpectClose(curve.At(0), Vector(expected.at("start")), tolerance);
    ExpectClose(curve.At(1), Vector(expected.at("end")), tolerance);
    for (int k = 0; k <= 1000; ++k) {
      const Eigen::Vector3d p = curve.At(k / 1000.0);
      EXPECT_NEAR(std::pow(p[0] / rx, 2) + std::pow(p[1] / ry, 2) - 1,
                  0,
                  expected.at("max_implicit_residual").get<double>());
      EXPECT_EQ(p[2], 0);
    }
  });
  EXPECT_EQ(seen, 13);
}

TEST(MakeCurveTest, FramesAreRightHandedAndKeepCoordinateAxes) {
  RandomSplines random(kSeed);
  for (int k = 0; k < 200; ++k) {
    const double scale = random.Logarithmic(1e-200, 1e200);
    const Eigen::Vector3d axis = random.Vector(1);
    const Frame frame = random.Coin() ? Frame({0, 0, 0}, scale * axis)
                                      : Frame({0, 0, 0}, axis, scale * random.Vector(1));
    Eigen::Matrix3d axes;
    axes << frame.x(), frame.y(), frame.axis();
    EXPECT_LE((axes.transpose() * axes - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_GT(axes.determinant(), 0);
    EXPECT_GT(frame.axis().dot(axis.normalized()), 1 - 1e-15);
  }
  const Frame up({1, 2, 3}, {0, 0, 7});
  EXPECT_EQ(up.axis(), Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(up.x(), Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(up.y(), Eigen::Vector3d(0, 1, 0));
}

TEST(MakeCurveTest, RefusalsNameValueAndRule) {
  EXPECT_THAT(RefusalOf([] { MakeArc(Frame(), 0); }), HasSubstr("MakeArc: radius = 0 is not"));
  EXPECT_THAT(RefusalOf([] { MakeArc(Frame(), std::nan("")); }), HasSubstr("radius = nan"));
  EXPECT_THAT(RefusalOf([] { MakeArc(Frame(), 1, {0, 7}); }), HasSubstr("sweep = 7 is not in"));
  EXPECT_THAT(RefusalOf([] { MakeArc(Frame(), 1, {0, 0}); }), HasSubstr("sweep = 0 is not in"));
  EXPECT_THAT(RefusalOf([] { MakeArc(Frame(), 1, {HUGE_VAL, 1}); }), HasSubstr("start = inf"));
  EXPECT_THAT(RefusalOf([] { MakeEllipseArc(Frame(), 1, -2); }), HasSubstr("radius_y = -2"));
  EXPECT_THAT(RefusalOf([] { MakeLine<2>({1, 2}, {1, 2}); }), HasSubstr("the ends are one point"));
  EXPECT_THAT(RefusalOf([] { Frame({0, 0, 0}, {0, 0, 0}); }), HasSubstr("axis = (0, 0, 0)"));
  EXPECT_THAT(RefusalOf([] { Frame({0, 0, 0}, {0, 0, 1}, {0, 0, 5}); }), HasSubstr("x = (0, 0, 5)"));
}

}  // namespace batten::internal::make_curve_test
