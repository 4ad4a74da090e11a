// SPDX-License-Identifier: MIT
#include "batten/geometry/arc_length.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "geometry/numeric/gauss_rule.h"
#include "exact_shapes.h"
#include "fixtures.h"
#include "quadrature.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::arc_length_test {

// The error that arc_length.h states.
constexpr double kStated = 1e-12;

// A Bézier curve from the polynomials x(t), y(t) of degree ≤ 3 on [low, high].
NurbsCurve<2> Cubic(const Eigen::Vector4d& x, const Eigen::Vector4d& y, double low, double high) {
  const auto blossom = [](const Eigen::Vector4d& c, double a, double b, double d) {
    return c[0] + c[1] * (a + b + d) / 3 + c[2] * (a * b + b * d + d * a) / 3 + c[3] * a * b * d;
  };
  Eigen::Matrix<double, 2, 4> points;
  for (int i = 0; i < 4; ++i) {
    const double a = i > 0 ? high : low, b = i > 1 ? high : low, d = i > 2 ? high : low;
    points.col(i) << blossom(x, a, b, d), blossom(y, a, b, d);
  }
  return NurbsCurve<2>(SplineBasis::Uniform(3, 4, low, high), points);
}

// On ever more parts of every span until the sum stands still: weights that differ by 10⁴ make the
// speed a needle.
template <int Dim>
double Reference(const NurbsCurve<Dim>& curve) {
  constexpr double kStandsStill = 1e-12;
  double sum = 0;
  for (const int span : curve.basis().Spans()) {
    const auto over = [&](int parts) {
      return CompositeGauss([&](double u) { return curve.Derivatives(u, 1).col(1).norm(); },
                            curve.basis().knots()[span],
                            curve.basis().knots()[span + 1],
                            parts);
    };
    int parts = 50;
    double last = over(parts), next = over(2 * parts);
    while (std::abs(next - last) > kStandsStill * next && parts < 50000) {
      parts *= 2;
      last = next;
      next = over(2 * parts);
    }
    sum += next;
  }
  return sum;
}

// A curve that is no point: one period of few knots may hold one control point only.
template <int Dim>
NurbsCurve<Dim> RandomCurve(RandomSplines& random) {
  for (;;) {
    const bool clamped = random.Coin(), periodic = random.Integer(0, 2) == 0;
    const auto curve =
        random.Curve<Dim>(random.Integer(1, 11),
                          random.Coin(),
                          {.clamped = clamped, .most_spans = 4, .periodic = periodic});
    if (!periodic || curve.basis().size() > curve.basis().degree() + 1) return curve;
  }
}

template <typename Check>
void ForRandomCurves(int count, Check check) {
  for (int seed = 0; seed < count; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(static_cast<unsigned>(seed));
    check(RandomCurve<3>(random), random);
    check(RandomCurve<2>(random), random);
  }
}

TEST(GaussRuleTest, IsExactForPolynomialsOfDegreeTwiceItsSizeLessOne) {
  for (int count = 1; count <= 40; ++count) {
    const GaussRule rule = GaussLegendre(count);
    for (int power = 0; power < 2 * count; ++power) {
      EXPECT_NEAR(
          rule.weights.dot(rule.nodes.array().pow(power).matrix()), 1.0 / (power + 1), 1e-15);
    }
  }
}

TEST(ArcLengthTest, OfACircleIsItsCircumference) {
  for (const double radius : {1e-9, 0.3, 1.0, 1e9}) {
    EXPECT_NEAR(ArcLength(Circle(radius)) / (2 * std::numbers::pi * radius), 1, kStated);
  }
}

TEST(ArcLengthTest, OfAParabolaIsItsClosedForm) {
  // y = x² on [0, 2]
  const double expected = std::sqrt(17.0) + std::asinh(4.0) / 4;
  EXPECT_NEAR(ArcLength(Cubic({0, 1, 0, 0}, {0, 0, 1, 0}, 0, 2)) / expected, 1, kStated);
}

TEST(ArcLengthTest, OfALineIsItsLengthForAnyWeights) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int degree = random.Integer(1, 11);
    Eigen::Matrix3Xd points(3, degree + 1);
    const Eigen::Vector3d a = random.Vector(1), b = random.Vector(1);
    for (int i = 0; i <= degree; ++i) points.col(i) = a + (b - a) * i / degree;
    const NurbsCurve<3> line(
        SplineBasis::Uniform(degree, degree + 1, 0, 1), points, random.Weights(degree + 1));
    EXPECT_NEAR(ArcLength(line) / (b - a).norm(), 1, kStated);
  }
}

// (t², t³) turns back at t = 0; |C′| = |t| sqrt(4 + 9 t²).
double CuspLength(double t) { return (std::pow(4 + 9 * t * t, 1.5) - 8) / 27; }

TEST(ArcLengthTest, IsExactAcrossACuspWhereverItIs) {
  // Very near an end too, where it falls between that and the first node of any rule.
  for (const double low : {1.0, 0.5, 0.3, 0.1, 1e-2, 3e-3, 1e-3, 1e-4, 1e-7}) {
    SCOPED_TRACE("from " + std::to_string(-low));
    const double expected = CuspLength(low) + CuspLength(1);
    EXPECT_NEAR(ArcLength(Cubic({0, 0, 1, 0}, {0, 0, 0, 1}, -low, 1)) / expected, 1, kStated);
    EXPECT_NEAR(ArcLength(Cubic({0, 0, 1, 0}, {0, 0, 0, 1}, -1, low)) / expected, 1, kStated);
  }
}

TEST(ArcLengthTest, IsExactWhereALineTurnsBack) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    // x = (t − a)², a in [0, 1], likely near an end
    const double a = random.Coin() ? random.Real(0, 1) : random.Logarithmic(1e-8, 1);
    const NurbsCurve<2> line = Cubic({a * a, -2 * a, 1, 0}, {0, 0, 0, 0}, 0, 1);
    EXPECT_NEAR(ArcLength(line), a * a + (1 - a) * (1 - a), kStated);
  }
}

TEST(ArcLengthTest, IsExactAcrossNearCusps) {
  // (t², e t) is a parabola whose speed has its least value e at t = 0.
  for (double e = 1; e > 1e-12; e /= 10) {
    for (const double low : {0.7, 1e-3}) {
      SCOPED_TRACE("least speed " + std::to_string(e) + " from " + std::to_string(-low));
      // ∫ sqrt(4t² + e²) dt
      const auto integral = [&](double t) {
        return t * std::sqrt(4 * t * t + e * e) / 2 + e * e * std::asinh(2 * t / e) / 4;
      };
      const double expected = integral(1) + integral(low);
      EXPECT_NEAR(ArcLength(Cubic({0, 0, 1, 0}, {0, e, 0, 0}, -low, 1)) / expected, 1, kStated);
    }
  }
}

TEST(ArcLengthTest, AgreesWithIndependentQuadrature) {
  ForRandomCurves(60, [](const auto& curve, RandomSplines&) {
    const double length = ArcLength(curve);
    EXPECT_NEAR(Reference(curve) / length, 1, kIterated);
  });
}

TEST(ArcLengthTest, IsAdditive) {
  ForRandomCurves(60, [](const auto& curve, RandomSplines& random) {
    double a = random.Parameter(curve.basis()), b = random.Parameter(curve.basis());
    if (a > b) std::swap(a, b);
    const double lower = curve.basis().lower(), upper = curve.basis().upper();
    const double whole = ArcLength(curve);
    const double parts =
        ArcLength(curve, lower, a) + ArcLength(curve, a, b) + ArcLength(curve, b, upper);
    EXPECT_NEAR(parts / whole, 1, kStated);
    EXPECT_EQ(ArcLength(curve, a, a), 0);
  });
}

TEST(ArcLengthTest, OfAShortStretchIsExactBesideTheStretch) {
  ForRandomCurves(40, [](const auto& curve, RandomSplines& random) {
    const auto& basis = curve.basis();
    const double width = 1e-6 * (basis.upper() - basis.lower());
    const double a = random.Real(basis.lower(), basis.upper() - width);
    const double chord = (curve.At(a + width) - curve.At(a)).norm();
    const double expected = CompositeGauss(
        [&](double u) { return curve.Derivatives(u, 1).col(1).norm(); }, a, a + width, 4);
    const double length = ArcLength(curve, a, a + width);
    // The ends, known to 1e-16, are a 1e-10 of the width.
    EXPECT_NEAR(length / expected, 1, kHalfDigits);
    EXPECT_GE(length, chord * (1 - kHalfDigits));
  });
}

TEST(ArcLengthTest, DoesNotDependOnPlaceOrParameterAndScales) {
  ForRandomCurves(60, [](const auto& curve, RandomSplines& random) {
    using Curve = std::decay_t<decltype(curve)>;
    constexpr int kDim = Curve::Point::RowsAtCompileTime;
    const double length = ArcLength(curve);
    const Eigen::Matrix3d turn = random.Orthogonal();
    typename Curve::Points points = curve.control_points();
    if constexpr (kDim == 3) points = turn * points;
    for (const double scale : {1e-9, 1.0, 1e9}) {
      const Curve moved(curve.basis(),
                        (scale * points).colwise() +
                            scale * typename Curve::Point(Eigen::Vector3d(3, -2, 5).head<kDim>()),
                        curve.weights());
      EXPECT_NEAR(ArcLength(moved) / (scale * length), 1, kStated);
    }
    if (curve.basis().periodic()) return;
    std::vector<double> knots = curve.basis().knots();
    std::reverse(knots.begin(), knots.end());
    for (double& u : knots) u = 7 - 3 * u;
    const Curve reversed(SplineBasis(curve.basis().degree(), knots),
                         curve.control_points().rowwise().reverse(),
                         curve.weights().reverse());
    EXPECT_NEAR(ArcLength(reversed) / length, 1, kStated);
  });
}

TEST(ArcLengthTest, GoesAcrossTheSeamOfAPeriodicCurve) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const auto curve = random.Curve<3>(random.Integer(1, 8), random.Coin(), {.periodic = true});
    if (curve.basis().size() == curve.basis().degree() + 1) continue;  // a point
    const double lower = curve.basis().lower(), upper = curve.basis().upper();
    const double period = upper - lower, whole = ArcLength(curve);
    const double a = random.Real(lower - 3 * period, upper + 3 * period);
    const double b = a + random.Real(0, 1) * period;
    const double parts = ArcLength(curve, a, b) + ArcLength(curve, b, a + period);
    EXPECT_NEAR(parts / whole, 1, kIterated);  // wrapped parameters are rounded
    EXPECT_THROW(ArcLength(curve, a, a + 1.01 * period), std::invalid_argument);
  }
}

TEST(ArcLengthTest, OfAPointIsZero) {
  const NurbsCurve<3> point(SplineBasis::Uniform(3, 6, 0, 1),
                            Eigen::Vector3d(1, 2, 3).replicate(1, 6),
                            Eigen::VectorXd::LinSpaced(6, 1, 2));
  EXPECT_LE(ArcLength(point), 1e-15);
  EXPECT_EQ(ArcLengthMap(point).ParameterAt(0), 0);
}

TEST(ArcLengthTest, RefusesStretchesThatAreNone) {
  const NurbsCurve<2> circle = Circle(1);
  EXPECT_THROW(ArcLength(circle, 0.5, 0.4), std::invalid_argument);
  EXPECT_THROW(ArcLength(circle, -0.1, 0.4), std::invalid_argument);
  EXPECT_THROW(ArcLength(circle, 0.1, 1.4), std::invalid_argument);
  EXPECT_THROW(ArcLength(circle, NAN, 0.4), std::invalid_argument);
}

TEST(ArcLengthMapTest, IsInvertedByParameterAt) {
  ForRandomCurves(60, [](const auto& curve, RandomSplines& random) {
    const ArcLengthMap map(curve);
    const double length = map.length();
    EXPECT_NEAR(length / ArcLength(curve), 1, kStated);
    EXPECT_EQ(map.ParameterAt(0), curve.basis().lower());
    EXPECT_EQ(map.ParameterAt(length), curve.basis().upper());
    for (int trial = 0; trial < 20; ++trial) {
      const double s = random.Real(0, length);
      const double u = map.ParameterAt(s);
      // The parameter itself is rounded, which moves the point by its speed times that.
      const double speed = curve.Derivatives(u, 1).col(1).norm();
      const double rounded = 4e-16 * (std::abs(u) + 1) * speed;
      EXPECT_NEAR(map.LengthAt(u), s, 2e-13 * length + rounded);
      EXPECT_NEAR(ArcLength(curve, curve.basis().lower(), u), s, kStated * length + rounded);
      EXPECT_LE(map.ParameterAt(s * 0.999), u);
    }
  });
}

TEST(ArcLengthMapTest, GoesThroughCuspsBothWays) {
  const NurbsCurve<2> cusp = Cubic({0, 0, 1, 0}, {0, 0, 0, 1}, -1, 1);
  const ArcLengthMap map(cusp);
  for (const double u : {-1.0, -0.5, -1e-3, -1e-6, 0.0, 1e-5, 0.3, 1.0}) {
    const double expected = CuspLength(1) + std::copysign(CuspLength(u), u);
    EXPECT_NEAR(map.LengthAt(u), expected, kStated);
    // Near the cusp the length is u²: half the digits of u are lost.
    EXPECT_NEAR(map.ParameterAt(map.LengthAt(u)), u, kHalfDigits);
    EXPECT_NEAR(map.LengthAt(map.ParameterAt(expected)), expected, 2e-13 * map.length());
  }
}

TEST(ArcLengthMapTest, RefusesLengthsBeyondTheCurve) {
  const NurbsCurve<2> circle = Circle(1);
  const double length = ArcLength(circle);
  for (const double s : {-0.1, 1.001 * length, static_cast<double>(NAN)}) {
    EXPECT_THROW(ParameterAtLength(circle, s), std::invalid_argument) << s;
  }
  EXPECT_EQ(ParameterAtLength(circle, length * (1 + 1e-15)), 1);
  EXPECT_NEAR(ParameterAtLength(circle, length / 4), 0.25, kRounding);
}

TEST(ArcLengthFixturesTest, LengthsAgreeWithOtherImplementations) {
  using namespace fixtures;
  int seen = 0;
  CheckAll("measures_curvature.json",
           [&](const Json& input, const Json& expected, double tolerance) {
             if (!expected.contains("length")) return;
             ++seen;
             const double length = InPlane(input.at("curve")) ? ArcLength(Curve<2>(input["curve"]))
                                                              : ArcLength(Curve<3>(input["curve"]));
             ExpectClose(length, expected.at("length"), tolerance);
           });
  EXPECT_EQ(seen, 14);
}

TEST(ArcLengthFixturesTest, ArcsAndEllipsesAreWhatTheirFormulasSay) {
  using namespace fixtures;
  int seen = 0;
  CheckAll("exact_primitives.json", [&](const Json& input, const Json& expected, double tolerance) {
    if (!expected.contains("length")) return;
    ++seen;
    const NurbsCurve<3> curve = Curve<3>(expected.at("one_valid_nurbs"));
    ExpectClose(ArcLength(curve), expected.at("length"), tolerance);
    const auto& basis = curve.basis();
    ExpectClose(curve.At(basis.lower()), Vector(expected.at("start")), tolerance);
    ExpectClose(curve.At(basis.upper()), Vector(expected.at("end")), tolerance);
    const double rx = input.at("radii")[0], ry = input.at("radii")[1];
    for (int k = 0; k <= 100; ++k) {
      const Eigen::Vector3d point =
          curve.At(basis.lower() + (basis.upper() - basis.lower()) * k / 100);
      const double residual = std::pow(point[0] / rx, 2) + std::pow(point[1] / ry, 2) - 1;
      EXPECT_NEAR(residual, 0, expected.at("max_implicit_residual").get<double>());
    }
  });
  EXPECT_EQ(seen, 13);
}

TEST(LongArcLengthTest, AgreesWithIndependentQuadratureOnManyCurves) {
  ForRandomCurves(1000, [](const auto& curve, RandomSplines&) {
    const double length = ArcLength(curve);
    EXPECT_NEAR(Reference(curve) / length, 1, 1e-10);
  });
}

}  // namespace batten::internal::arc_length_test
