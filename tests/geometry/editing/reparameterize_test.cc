// SPDX-License-Identifier: MIT
#include "batten/geometry/reparameterize.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "batten/geometry/iso_curve.h"
#include "exact_shapes.h"
#include "law_cases.h"
#include "shape_edits.h"
#include "tolerances.h"

namespace batten::internal::reparameterize_test {

// u = (α·s + β) / (γ·s + δ), evaluated with digits to spare.
struct Mobius {
  double alpha, beta, gamma, delta;

  double operator()(double s) const {
    const long double t = s;
    return static_cast<double>((alpha * t + beta) / (gamma * t + delta));
  }
  // f', f'' and f''' at s, from f' = det / (γs + δ)².
  Eigen::Vector3d Derivatives(double s) const {
    const double d = gamma * s + delta, first = (alpha * delta - beta * gamma) / (d * d);
    return {first, -2 * gamma / d * first, 6 * gamma * gamma / (d * d) * first};
  }
  Mobius Inverse() const { return {delta, -beta, -gamma, alpha}; }
};

// Onto [a, b] from [c, d], with γs + δ at d being 1/ratio of that at c.
Mobius MobiusBetween(double a, double b, double c, double d, double ratio) {
  const double k = 1 - ratio, delta = ratio * (d - c) - k * c;
  return {a * k + (b - a), a * delta - (b - a) * c, k, delta};
}

Mobius RandomMobius(const SplineBasis& basis, RandomSplines& random) {
  const double c = random.Real(-3, 3), d = c + random.Logarithmic(0.1, 10);
  const Mobius f = MobiusBetween(basis.lower(), basis.upper(), c, d, random.Logarithmic(0.1, 10));
  const double factor = random.Coin() ? -2 : 0.5;  // the map is the same
  return {factor * f.alpha, factor * f.beta, factor * f.gamma, factor * f.delta};
}

template <int Dim>
NurbsCurve<Dim> Traced(const NurbsCurve<Dim>& curve, const Mobius& f) {
  return MobiusReparameterized(curve, f.alpha, f.beta, f.gamma, f.delta);
}
NurbsSurface Traced(const NurbsSurface& surface, Direction direction, const Mobius& f) {
  return MobiusReparameterized(surface, direction, f.alpha, f.beta, f.gamma, f.delta);
}

// Knots are right to some roundings of the domain's extent, each of which moves the point by the
// speed there; the weights and the evaluations by ε of the extent for each degree.
template <int Dim>
double Bound(const NurbsCurve<Dim>& old, const NurbsCurve<Dim>& traced) {
  const double moved = DomainExtent(old.basis()) * GreatestDerivative(old, 1) +
                       DomainExtent(traced.basis()) * GreatestDerivative(traced, 1);
  return 8 * kUnitRoundoff * ((old.basis().degree() + 1) * ExtentOf(old) + moved);
}

// The same for the k-th derivative, whose own rounding is that of differences over the shortest
// span, and which a knot moved by a part of that span changes by p times that part.
template <int Dim>
double DerivativeBound(const NurbsCurve<Dim>& old, const NurbsCurve<Dim>& traced, int k) {
  const SplineBasis& basis = traced.basis();
  const double p = basis.degree(), shortest = ShortestSpan(basis);
  const double differences =
      std::pow(2 * p / shortest, k) * ExtentOf(old) * WeightRatio(traced.weights());
  const double moved = DomainExtent(basis) * (GreatestDerivative(traced, k + 1) +
                                              p / shortest * GreatestDerivative(traced, k));
  return 16 * kUnitRoundoff * (differences + moved);
}

// C̃ = C∘f up to the second derivative.
template <int Dim, typename Map>
void ExpectTraces(const NurbsCurve<Dim>& old,
                  const NurbsCurve<Dim>& traced,
                  const Map& f,
                  RandomSplines& random) {
  const double bound = Bound(old, traced);
  const double bound_1 = DerivativeBound(old, traced, 1);
  const double bound_2 = DerivativeBound(old, traced, 2);
  for (int trial = 0; trial < 5; ++trial) {
    const double s = random.Parameter(traced.basis()), u = f(s);
    EXPECT_LE((traced.At(s) - old.At(u)).norm(), bound) << "s = " << s;
  }
  for (const int span : traced.basis().Spans()) {
    const double a = traced.basis().knots()[span], b = traced.basis().knots()[span + 1];
    const double s = a + random.Real(0.01, 0.99) * (b - a);
    const Eigen::Vector3d g = f.Derivatives(s);
    const auto c = old.Derivatives(f(s), 2), got = traced.Derivatives(s, 2);
    EXPECT_LE((got.col(1) - c.col(1) * g[0]).norm(), bound_1);
    EXPECT_LE((got.col(2) - c.col(2) * g[0] * g[0] - c.col(1) * g[1]).norm(), bound_2);
  }
}

template <int Dim>
void CheckLinearCurves() {
  ForRandomCurves<Dim>([](const NurbsCurve<Dim>& unit, RandomSplines& random) {
    for (const double scale : kCoordinateScales) {
      const NurbsCurve<Dim> curve = Enlarged(unit, scale);
      const double a = random.Real(-5, 5), b = a + random.Logarithmic(1e-3, 1e3);
      const NurbsCurve<Dim> traced = Reparameterized(curve, a, b);
      EXPECT_EQ(traced.basis().lower(), a);
      EXPECT_EQ(traced.basis().upper(), b);
      EXPECT_EQ(traced.basis().periodic(), curve.basis().periodic());
      EXPECT_EQ(traced.control_points(), curve.control_points());
      EXPECT_EQ(traced.weights(), curve.weights());
      ExpectTraces(curve,
                   traced,
                   MobiusBetween(curve.basis().lower(), curve.basis().upper(), a, b, 1),
                   random);
    }
  });
}

TEST(ReparameterizeTest, LinearMapsOfCurvesChangeOnlyKnots) {
  CheckLinearCurves<2>();
  CheckLinearCurves<3>();
}

template <int Dim>
void CheckMobiusCurves() {
  ForRandomCurves<Dim>([](const NurbsCurve<Dim>& unit, RandomSplines& random) {
    for (const double scale : kCoordinateScales) {
      const NurbsCurve<Dim> curve = Enlarged(unit, scale);
      const Mobius f = RandomMobius(curve.basis(), random);
      const NurbsCurve<Dim> traced = Traced(curve, f);
      if (curve.basis().clamped()) {
        EXPECT_EQ(traced.control_points(), curve.control_points());
        EXPECT_EQ(traced.weights()[0], curve.weights()[0]);
      }
      ExpectTraces(curve, traced, f, random);
    }
  });
}

TEST(ReparameterizeTest, MobiusMapsOfCurvesTraceTheSameShape) {
  CheckMobiusCurves<2>();
  CheckMobiusCurves<3>();
}

// Along a line of constant other parameter it is the law for curves.
TEST(ReparameterizeTest, MapsOfSurfacesTraceTheSameShape) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    for (const bool along_u : {true, false}) {
      const Direction direction = along_u ? Direction::kU : Direction::kV;
      const Direction fixed = along_u ? Direction::kV : Direction::kU;
      const SplineBasis& basis = along_u ? surface.basis_u() : surface.basis_v();
      const SplineBasis& other = along_u ? surface.basis_v() : surface.basis_u();
      const double t = random.Parameter(other), a = random.Real(-5, 5), b = a + 2;
      const NurbsCurve<3> before = IsoCurve(surface, fixed, t);
      const NurbsSurface linear = Reparameterized(surface, direction, a, b);
      EXPECT_EQ(linear.control_points(), surface.control_points());
      EXPECT_EQ(linear.weights(), surface.weights());
      ExpectTraces(before,
                   IsoCurve(linear, fixed, t),
                   MobiusBetween(basis.lower(), basis.upper(), a, b, 1),
                   random);
      const Mobius f = RandomMobius(basis, random);
      ExpectTraces(before, IsoCurve(Traced(surface, direction, f), fixed, t), f, random);
    }
  });
}

TEST(ReparameterizeTest, TheInverseMapUndoes) {
  ForRandomCurves<3>([](const NurbsCurve<3>& curve, RandomSplines& random) {
    if (curve.basis().periodic()) return;  // comes back clamped
    const Mobius f = RandomMobius(curve.basis(), random);
    const NurbsCurve<3> back = Traced(Traced(curve, f), f.Inverse());
    if (back.basis().size() != curve.basis().size()) return;  // was clamped for the pole's sake
    if (!curve.basis().clamped() && back.basis().clamped()) return;
    const Eigen::VectorXd ratios = back.weights().cwiseQuotient(curve.weights());
    EXPECT_LE(WeightRatio(ratios) - 1, kRounding);
    EXPECT_EQ(back.control_points(), curve.control_points());
    for (size_t i = 0; i < curve.basis().knots().size(); ++i) {
      EXPECT_NEAR(back.basis().knots()[i], curve.basis().knots()[i], kRounding * 100);
    }
  });
}

TEST(ReparameterizeTest, OneMapAfterTheOtherIsTheirProduct) {
  ForRandomCurves<2>([](const NurbsCurve<2>& curve, RandomSplines& random) {
    const Mobius f = RandomMobius(curve.basis(), random);
    const NurbsCurve<2> once = Traced(curve, f);
    const Mobius g = RandomMobius(once.basis(), random);
    const NurbsCurve<2> twice = Traced(once, g);
    const Mobius product{f.alpha * g.alpha + f.beta * g.gamma,
                         f.alpha * g.beta + f.beta * g.delta,
                         f.gamma * g.alpha + f.delta * g.gamma,
                         f.gamma * g.beta + f.delta * g.delta};
    const NurbsCurve<2> at_once = Traced(curve, product);
    const double bound = Bound(once, twice) + Bound(curve, once) + Bound(curve, at_once);
    for (int trial = 0; trial < 5; ++trial) {
      const double s = random.Parameter(twice.basis());
      EXPECT_LE((twice.At(s) - at_once.At(s)).norm(), bound);
    }
  });
}

TEST(ReparameterizeTest, AMapOfABezierCurveOntoItsDomainChangesOnlyWeights) {
  RandomSplines random(1);
  for (int p = 1; p <= 11; ++p) {
    const NurbsCurve<3> curve = random.Curve<3>(p, p % 2 == 0, {.most_spans = 1});
    const double a = curve.basis().lower(), b = curve.basis().upper();
    const NurbsCurve<3> traced = WithEndWeights(curve, 1, 50);
    EXPECT_EQ(traced.basis(), curve.basis());
    EXPECT_EQ(traced.control_points(), curve.control_points());
    // w̃_i = w_i·c·r^i, so that the cross ratios of neighbours stay.
    const Eigen::VectorXd factors = traced.weights().cwiseQuotient(curve.weights());
    for (int i = 1; i < p; ++i) {
      EXPECT_NEAR(factors[i] * factors[i] / (factors[i - 1] * factors[i + 1]), 1, kRounding);
    }
    EXPECT_EQ(traced.At(a), curve.At(a));
    EXPECT_LE((traced.At(b) - curve.At(b)).norm(), kRounding);
  }
}

TEST(ReparameterizeTest, EndWeightsAreWhatIsAskedFor) {
  ForRandomCurves<3>([](const NurbsCurve<3>& curve, RandomSplines& random) {
    const double first = random.Logarithmic(0.1, 10);
    const double last = random.Coin() ? first : random.Logarithmic(0.1, 10);
    const NurbsCurve<3> traced = WithEndWeights(curve, first, last);
    const SplineBasis& basis = traced.basis();
    EXPECT_EQ(basis.lower(), curve.basis().lower());
    EXPECT_EQ(basis.upper(), curve.basis().upper());
    EXPECT_EQ(basis.periodic(), curve.basis().periodic() && first == last);
    const auto weight_at = [&](double u) {
      const int span = basis.Span(u), p = basis.degree();
      Eigen::VectorXd N(p + 1);
      basis.Values(span, u, N.data());
      return N.dot(traced.weights().segment(span - p, p + 1));
    };
    EXPECT_NEAR(weight_at(basis.lower()) / first, 1, kRounding);
    EXPECT_NEAR(weight_at(basis.upper()) / last, 1, kRounding);
    if (basis.clamped()) {
      EXPECT_EQ(traced.weights()[0], first);
      EXPECT_EQ(traced.weights()[basis.size() - 1], last);
    }
    // The same set of points: every point of one is one of the other at a parameter that follows
    // from the ratio of the weights there; here the ends and the control points suffice.
    EXPECT_LE((traced.At(basis.lower()) - curve.At(basis.lower())).norm(), kRounding * 10);
    EXPECT_LE((traced.At(basis.upper()) - curve.At(basis.upper())).norm(), kRounding * 10);
  });
}

// The quarter circle with weights 1, √2/2, 1 is the one with weights 1, 1, 2. [Piegl & Tiller 1997,
// Ex. 7.1]
TEST(ReparameterizeTest, TheTwoQuarterCirclesOfTheBookAreOne) {
  const Eigen::Matrix2Xd points{{1, 1, 0}, {0, 1, 1}};
  const SplineBasis basis(2, {0, 0, 0, 1, 1, 1});
  const NurbsCurve<2> even(basis, points, Eigen::Vector3d(1, std::numbers::sqrt2 / 2, 1));
  const NurbsCurve<2> simple = WithEndWeights(even, 1, 2);
  EXPECT_NEAR(simple.weights()[1], 1, 4 * kUnitRoundoff);
  for (double t = 0; t <= 1; t += 1.0 / 16) {
    const Eigen::Vector2d exact((1 - t * t) / (1 + t * t), 2 * t / (1 + t * t));
    EXPECT_LE((simple.At(t) - exact).norm(), 16 * kUnitRoundoff);
  }
}

TEST(ReparameterizeTest, PeriodicShapesStayPeriodicUnderLinearMapsOnly) {
  RandomSplines random(2);
  for (int p = 1; p <= 11; ++p) {
    SCOPED_TRACE(p);
    const NurbsCurve<3> curve = random.Curve<3>(p, true, KindOfBasis(2));
    EXPECT_TRUE(Reparameterized(curve, 1e9, 1e9 + 10).basis().periodic());
    EXPECT_TRUE(Reparameterized(Reparameterized(curve, 1e9, 1e9 + 10), 0, 1).basis().periodic());
    const Mobius linear = MobiusBetween(curve.basis().lower(), curve.basis().upper(), 0, 3, 1);
    EXPECT_TRUE(Traced(curve, linear).basis().periodic());
    const Mobius f = MobiusBetween(curve.basis().lower(), curve.basis().upper(), 0, 1, 3);
    const NurbsCurve<3> closed = Traced(curve, f);
    EXPECT_FALSE(closed.basis().periodic());
    EXPECT_TRUE(closed.basis().clamped());
    const auto first = closed.control_points().col(0);
    const auto last = closed.control_points().col(closed.basis().size() - 1);
    EXPECT_LE((first - last).norm(), kRounding);
  }
}

TEST(ReparameterizeTest, AnUnclampedCurveIsClampedWhenAKnotLiesBeyondThePole) {
  const NurbsCurve<2> curve(SplineBasis(2, {-2, -1, 0, 1, 2, 3}),
                            Eigen::Matrix2Xd{{0, 1, 2}, {0, 1, 0}});
  // α − γu vanishes at u = 2.5, beyond the domain [0, 1] and before the last knot.
  const NurbsCurve<2> traced = MobiusReparameterized(curve, 2.5, 0, 1, 1);
  EXPECT_TRUE(traced.basis().clamped());
  const NurbsCurve<2> open = MobiusReparameterized(curve, 5, 0, 1, 1);
  EXPECT_FALSE(open.basis().clamped());
  EXPECT_EQ(open.control_points(), curve.control_points());
  for (double s = 0; s <= 0.25; s += 1.0 / 64) {
    EXPECT_LE((open.At(s) - curve.At(5 * s / (s + 1))).norm(), kRounding);
  }
}

TEST(ReparameterizeTest, KnotsFarFromZeroKeepTheirMultiplicities) {
  const NurbsCurve<2> curve(SplineBasis(2, {0, 0, 0, 0.25, 0.25, 0.75, 1, 1, 1}),
                            Eigen::Matrix2Xd::Random(2, 6));
  const NurbsCurve<2> far = Reparameterized(curve, 1e9, 1e9 + 1);
  EXPECT_THAT(far.basis().knots(),
              testing::ElementsAre(
                  1e9, 1e9, 1e9, 1e9 + 0.25, 1e9 + 0.25, 1e9 + 0.75, 1e9 + 1, 1e9 + 1, 1e9 + 1));
  EXPECT_EQ(Reparameterized(far, 0, 1), curve);
  EXPECT_EQ(Reparameterized(Reparameterized(curve, 0, 1e-300), 0, 1), curve);
}

TEST(ReparameterizeTest, RefusesWhatItCannotDo) {
  const NurbsCurve<2> curve(SplineBasis(2, {0, 0, 0, 0.25, 0.5, 1, 1, 1}),
                            Eigen::Matrix2Xd::Random(2, 5));
  const NurbsSurface sphere = Sphere(1);
  EXPECT_EQ(RefusalOf([&] { Reparameterized(curve, 1, 1); }),
            "Reparameterized: the new domain [1, 1] is not an increasing, finite interval");
  EXPECT_THAT(RefusalOf([&] { Reparameterized(sphere, Direction::kU, 2, -3); }),
              testing::HasSubstr("[2, -3] is not an increasing"));
  EXPECT_THAT(RefusalOf([&] { Reparameterized(curve, NAN, 1); }), testing::HasSubstr("increasing"));
  EXPECT_THAT(RefusalOf([&] { Reparameterized(curve, -1e308, 1e308); }),
              testing::HasSubstr("finite interval"));
  EXPECT_EQ(RefusalOf([&] { Reparameterized(curve, 1e16, 1e16 + 4); }),
            "Reparameterized: knots 0 and 0.25 would fall together in the new domain "
            "[1e+16, 10000000000000004]");
  const auto mobius = [&](double a, double b, double c, double d) {
    return RefusalOf([&] { MobiusReparameterized(curve, a, b, c, d); });
  };
  EXPECT_THAT(mobius(1, 0, 0, -1), testing::HasSubstr("is not positive"));
  EXPECT_THAT(mobius(1, 1, 1, 1), testing::HasSubstr("is not positive"));
  EXPECT_THAT(mobius(0, 0, 0, 0), testing::HasSubstr("all zero"));
  EXPECT_THAT(mobius(1, NAN, 0, 1), testing::HasSubstr("not finite"));
  EXPECT_EQ(mobius(0.5, 0, 1, 1),
            "MobiusReparameterized: the pole u = alpha / gamma = 0.5 lies in the domain [0, 1]");
  EXPECT_THAT(mobius(1, 0, 1, 1), testing::HasSubstr("pole u = alpha / gamma = 1 lies"));
  EXPECT_THAT(mobius(0, -1, 1, 1), testing::HasSubstr("pole u = alpha / gamma = 0 lies"));
  EXPECT_THAT(RefusalOf([&] { WithEndWeights(curve, 1, 0); }),
              testing::HasSubstr("end weight 0 is not positive"));
  EXPECT_THAT(RefusalOf([&] { WithEndWeights(curve, NAN, 1); }), testing::HasSubstr("positive"));
  const NurbsCurve<2> line(SplineBasis(1, {0, 0, 0.25, 0.25}), Eigen::Matrix2d::Identity());
  EXPECT_THAT(RefusalOf([&] { WithEndWeights(line, 5e-324, 1); }),
              testing::HasSubstr("leave the range of numbers"));
}

}  // namespace batten::internal::reparameterize_test
