// SPDX-License-Identifier: MIT
#include "batten/geometry/composition.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/editing/composed_blossom.h"
#include "batten/geometry/iso_curve.h"
#include "exact_shapes.h"
#include "law_cases.h"
#include "shape_edits.h"
#include "tolerances.h"

namespace batten::internal::composition_test {

// The k-th derivative of f, k ≤ 3.
double Derivative(const ScalarSpline& f, double s, int k) {
  const int q = f.basis.degree(), span = f.basis.Span(s);
  std::vector<double> N(4 * (q + 1));
  f.basis.Derivatives(span, s, k, N.data());
  double sum = 0;
  for (int r = 0; r <= q; ++r) sum += N[k * (q + 1) + r] * f.coefficients[span - q + r];
  return sum;
}

double GreatestSlope(const ScalarSpline& f) {
  double greatest = 0;
  for (const int span : f.basis.Spans()) {
    const double a = f.basis.knots()[span], b = f.basis.knots()[span + 1];
    for (double t = 0; t < 1; t += 1.0 / 32) {
      greatest = std::max(greatest, Derivative(f, a + t * (b - a), 1));
    }
  }
  return greatest;
}

// Scales and shifts the values so that f maps its domain onto [a, b].
ScalarSpline Onto(double a, double b, ScalarSpline f) {
  const double low = f.At(f.basis.lower()), high = f.At(f.basis.upper());
  f.coefficients = a + (f.coefficients.array() - low) * ((b - a) / (high - low));
  return f;
}

// Coefficients that increase by steps of different size; over a periodic basis the steps repeat.
ScalarSpline RandomMap(const SplineBasis& basis, const SplineBasis& onto, RandomSplines& random) {
  const int round = basis.periodic() ? basis.size() - basis.degree() : basis.size();
  std::vector<double> steps(round);
  for (double& step : steps) step = random.Logarithmic(0.1, 1);
  Eigen::VectorXd c(basis.size());
  double value = 0;
  for (int i = 0; i < basis.size(); ++i) {
    c[i] = value;
    value += steps[i % round];
  }
  return Onto(onto.lower(), onto.upper(), {basis, c});
}

// The rounding bound of the header.
template <int Dim>
double Bound(const NurbsCurve<Dim>& curve, const ScalarSpline& f) {
  const double moved = GreatestDerivative(curve, 1) *
                       (DomainExtent(curve.basis()) + GreatestSlope(f) * DomainExtent(f.basis));
  const int degree = curve.basis().degree() * f.basis.degree();
  return (16 + 2 * degree) * kUnitRoundoff * (ExtentOf(curve) + moved);
}

template <int Dim>
void ExpectIsComposition(const NurbsCurve<Dim>& curve,
                         const ScalarSpline& f,
                         const NurbsCurve<Dim>& result,
                         RandomSplines& random) {
  const double bound = Bound(curve, f);
  EXPECT_EQ(result.basis().lower(), f.basis.lower());
  EXPECT_EQ(result.basis().upper(), f.basis.upper());
  EXPECT_EQ(result.basis().degree(), curve.basis().degree() * f.basis.degree());
  EXPECT_TRUE(curve.rational() || !result.rational());
  for (int trial = 0; trial < 8; ++trial) {
    const double s = random.Parameter(f.basis);
    EXPECT_LE((result.At(s) - curve.At(f.At(s))).norm(), bound) << "s = " << s;
  }
}

// Calls law(curve, f, random) for all pairs of degrees with a product up to 25; of each, curves of
// all kinds, every second one rational, and maps over bases of all kinds.
template <int Dim, typename Law>
void ForRandomCompositions(const Law& law, unsigned seeds, int most_degree = kMaxDegree) {
  for (int p = 1; p <= kHighestDegree; ++p) {
    for (int q = 1; p * q <= most_degree; ++q) {
      for (unsigned seed = 0; seed < seeds; ++seed) {
        SCOPED_TRACE("dimension " + std::to_string(Dim) + ", p = " + std::to_string(p) +
                     ", q = " + std::to_string(q) + ", seed " + std::to_string(seed));
        RandomSplines random(10000 * p + 100 * q + seed);
        const int kind = static_cast<int>(seed / 2) % 3;
        const NurbsCurve<Dim> curve = random.Curve<Dim>(p, seed % 2 == 1, KindOfBasis(kind, 4));
        const int map_kind = kind == 2 && seed % 4 < 2 ? 2 : random.Integer(0, 2);
        const SplineBasis basis = random.Basis(q, KindOfBasis(map_kind, 4));
        law(curve, RandomMap(basis, curve.basis(), random), random);
        if (testing::Test::HasFailure()) return;
      }
    }
  }
}

template <int Dim>
void CheckCurves(unsigned seeds) {
  ForRandomCompositions<Dim>(
      [](const NurbsCurve<Dim>& unit, const ScalarSpline& f, RandomSplines& random) {
        const double scale = kCoordinateScales[random.Integer(0, 2)];
        const NurbsCurve<Dim> curve = Enlarged(unit, scale);
        const NurbsCurve<Dim> result = Composed(curve, f);
        EXPECT_EQ(result.basis().periodic(), curve.basis().periodic() && f.basis.periodic());
        ExpectIsComposition(curve, f, result, random);
      },
      seeds);
}

TEST(CompositionTest, TracesTheCurveByTheMap) {
  CheckCurves<2>(6);
  CheckCurves<3>(6);
}

TEST(LongCompositionTest, TracesTheCurveByTheMap) { CheckCurves<3>(200); }

// C̃' = C'·f', C̃'' = C''·f'² + C'·f''. Rounding as for differences over the shortest span.
TEST(CompositionTest, HasTheDerivativesOfTheChainRule) {
  ForRandomCompositions<3>(
      [](const NurbsCurve<3>& curve, const ScalarSpline& f, RandomSplines& random) {
        const NurbsCurve<3> result = Composed(curve, f);
        const SplineBasis& basis = result.basis();
        const double degree = basis.degree(), shortest = ShortestSpan(basis);
        Eigen::Vector2d bounds;
        for (int k = 1; k <= 2; ++k) {
          const double differences =
              std::pow(2 * degree / shortest, k) * WeightRatio(result.weights()) * ExtentOf(result);
          const double moved =
              DomainExtent(basis) * (GreatestDerivative(result, k + 1) +
                                     degree / shortest * GreatestDerivative(result, k));
          bounds[k - 1] = 16 * kUnitRoundoff * (differences + moved);
        }
        for (const int span : basis.Spans()) {
          const double a = basis.knots()[span], b = basis.knots()[span + 1];
          const double s = a + random.Real(0.01, 0.99) * (b - a), u = f.At(s);
          const double f1 = Derivative(f, s, 1), f2 = Derivative(f, s, 2);
          const auto c = curve.Derivatives(u, 2), got = result.Derivatives(s, 2);
          for (int k = 1; k <= 2; ++k) {
            const Eigen::Vector3d exact = k == 1
                                              ? Eigen::Vector3d(c.col(1) * f1)
                                              : Eigen::Vector3d(c.col(2) * f1 * f1 + c.col(1) * f2);
            EXPECT_LE((got.col(k) - exact).norm(), bounds[k - 1]) << "order " << k << " at " << s;
          }
        }
      },
      3);
}

// Where f has a knot of multiplicity k and C one of multiplicity l, C∘f is continuous of order
// min(q − k, p − l) and the result says so by its knots, no less.
TEST(CompositionTest, KnotsTellTheContinuityOfTheComposition) {
  ForRandomCompositions<2>(
      [](const NurbsCurve<2>& shape, const ScalarSpline& f, RandomSplines&) {
        // Without weights, for whose sake a result may have more knots.
        const NurbsCurve<2> curve(shape.basis(), shape.control_points());
        const NurbsCurve<2> result = Composed(curve, f);
        const SplineBasis &c = curve.basis(), &r = result.basis();
        const int p = c.degree(), q = f.basis.degree();
        std::vector<double> expected;
        for (const double t : f.basis.knots()) {
          if (t <= r.lower() || t >= r.upper() || (!expected.empty() && t == expected.back())) {
            continue;
          }
          expected.push_back(t);
          EXPECT_EQ(r.Multiplicity(t), p * q - (q - f.basis.Multiplicity(t))) << "at " << t;
        }
        for (const double u : c.knots()) {
          if (u <= c.lower() || u >= c.upper()) continue;
          int found = 0;
          for (const int span : r.Spans()) {
            const double s = r.knots()[span];
            if (s <= r.lower() || std::abs(f.At(s) - u) > 1e-13 * DomainExtent(c)) continue;
            ++found;
            EXPECT_EQ(r.Multiplicity(s), p * q - (p - c.Multiplicity(u))) << "at " << s;
          }
          EXPECT_EQ(found, 1) << "for the knot " << u;
        }
      },
      6);
}

// Where knots of both meet, the place is one knot of the lower continuity.
TEST(CompositionTest, KnotsThatMeetBecomeOne) {
  const NurbsCurve<2> curve(SplineBasis(3, {0, 0, 0, 0, 1, 1, 2, 2, 2, 2}),
                            Eigen::Matrix2Xd::Random(2, 6));
  // f = 1 at its knot s = 1/3, by coefficients that only reach it in rounding.
  const SplineBasis basis(2, {0, 0, 0, 1.0 / 3, 0.7, 0.7, 0.7});
  ScalarSpline f{basis, Eigen::Vector4d(0, 0.7, 0, 2)};
  const double N1 = (0.7 - 1.0 / 3) / 0.7, N2 = 1 - N1;
  f.coefficients[2] = (1 - N1 * 0.7) / N2;
  const NurbsCurve<2> result = Composed(curve, f);
  EXPECT_EQ(result.basis().Spans().size(), 2u);
  EXPECT_EQ(result.basis().Multiplicity(1.0 / 3), 6 - std::min(2 - 1, 3 - 2));
  RandomSplines random(1);
  ExpectIsComposition(curve, f, result, random);
}

TEST(CompositionTest, TracesSurfacesByTheMapInEitherDirection) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    RandomSplines random(seed);
    const int p = random.Integer(1, 6), q = random.Integer(1, 25 / p);
    const bool along_u = random.Coin();
    const int kind = random.Integer(0, 2);
    const BasisKind own = KindOfBasis(kind, 3), other = KindOfBasis(random.Integer(0, 2), 3);
    const int other_degree = random.Integer(1, 4);
    const NurbsSurface surface = along_u
                                     ? random.Surface(p, other_degree, seed % 2 == 1, own, other)
                                     : random.Surface(other_degree, p, seed % 2 == 1, other, own);
    const SplineBasis& basis = along_u ? surface.basis_u() : surface.basis_v();
    const SplineBasis& across = along_u ? surface.basis_v() : surface.basis_u();
    const ScalarSpline f =
        RandomMap(random.Basis(q, KindOfBasis(random.Integer(0, 2), 3)), basis, random);
    const Direction direction = along_u ? Direction::kU : Direction::kV;
    const Direction fixed = along_u ? Direction::kV : Direction::kU;
    const NurbsSurface result = Composed(surface, direction, f);
    EXPECT_EQ((along_u ? result.basis_v() : result.basis_u()), across);
    for (int trial = 0; trial < 3; ++trial) {
      const double t = random.Parameter(across);
      ExpectIsComposition(IsoCurve(surface, fixed, t), f, IsoCurve(result, fixed, t), random);
    }
  }
}

TEST(CompositionTest, ALinearMapChangesOnlyKnots) {
  ForRandomCurves<3>([](const NurbsCurve<3>& curve, RandomSplines&) {
    if (!curve.basis().clamped() || curve.rational()) return;
    const double a = curve.basis().lower(), b = curve.basis().upper();
    const ScalarSpline f{SplineBasis(1, {0, 0, 1, 1}), Eigen::Vector2d(a, b)};
    const NurbsCurve<3> result = Composed(curve, f);
    ASSERT_EQ(result.basis().size(), curve.basis().size());
    // A control point is the value of the polar form at knots that rounding has moved.
    EXPECT_LE((result.control_points() - curve.control_points()).cwiseAbs().maxCoeff(), kRounding);
  });
}

// f∘g by pieces of straight lines, whose inverse is of the same kind.
TEST(CompositionTest, TheInverseMapUndoes) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    RandomSplines random(seed);
    const NurbsCurve<3> curve =
        random.Curve<3>(random.Integer(1, 11), seed % 2 == 1, KindOfBasis(seed % 3));
    const SplineBasis& basis = curve.basis();
    const ScalarSpline f = RandomMap(random.Basis(1, {.most_spans = 4}), basis, random);
    std::vector<double> values(f.coefficients.begin(), f.coefficients.end());
    std::vector<double> places(f.basis.knots().begin() + 1, f.basis.knots().end() - 1);
    const ScalarSpline inverse{
        SplineBasis::Clamped(1, values),
        Eigen::Map<Eigen::VectorXd>(places.data(), static_cast<Eigen::Index>(places.size()))};
    const NurbsCurve<3> there = Composed(curve, f), back = Composed(there, inverse);
    const double bound = Bound(curve, f) + Bound(there, inverse);
    for (int trial = 0; trial < 10; ++trial) {
      const double u = random.Parameter(basis);
      EXPECT_LE((back.At(u) - curve.At(u)).norm(), bound);
    }
  }
}

TEST(CompositionTest, OneMapAfterTheOtherIsTheirComposition) {
  for (unsigned seed = 0; seed < 80; ++seed) {
    SCOPED_TRACE(seed);
    RandomSplines random(seed);
    const int p = random.Integer(1, 4), q = random.Integer(1, 3);
    const int kind = static_cast<int>(seed % 3);
    const NurbsCurve<2> curve = random.Curve<2>(p, seed % 2 == 1, KindOfBasis(kind, 3));
    const ScalarSpline f = RandomMap(random.Basis(q, KindOfBasis(kind, 3)), curve.basis(), random);
    const ScalarSpline g =
        RandomMap(random.Basis(random.Integer(1, 2), KindOfBasis(kind, 3)), f.basis, random);
    const NurbsCurve<2> once = Composed(curve, f), twice = Composed(once, g);
    const ScalarSpline both = Composed(f, g);
    EXPECT_EQ(both.basis.periodic(), kind == 2);
    const NurbsCurve<2> at_once = Composed(curve, both);
    EXPECT_EQ(at_once.basis().periodic(), kind == 2);
    const double bound = Bound(curve, f) + Bound(once, g) + Bound(curve, both);
    for (int trial = 0; trial < 10; ++trial) {
      const double s = random.Parameter(g.basis);
      EXPECT_NEAR(both.At(s), f.At(g.At(s)), kRounding * 100);
      EXPECT_LE((twice.At(s) - at_once.At(s)).norm(), bound);
    }
  }
}

// Maps whose coefficients do not increase though their values do; with weights from 1e-2 to 1e2 the
// blossoms of the weights may then be negative and knots have to be inserted.
TEST(LongCompositionTest, WeightsStayPositiveUnderAnyIncreasingMap) {
  int refined = 0, composed = 0;
  for (unsigned seed = 0; seed < 20000; ++seed) {
    SCOPED_TRACE(seed);
    RandomSplines random(seed);
    const int q = random.Integer(2, 8), p = random.Integer(1, 25 / q);
    const NurbsCurve<3> curve = random.Curve<3>(p, true, KindOfBasis(random.Integer(0, 2), 4));
    const SplineBasis basis = random.Basis(q, {.most_spans = 2});
    Eigen::VectorXd c(basis.size());
    double value = 0;
    for (double& x : c) {
      x = value;
      value += random.Real(-0.6, 1);
    }
    if (c[c.size() - 1] < 0.1) continue;
    const ScalarSpline f =
        Onto(curve.basis().lower(), curve.basis().upper(), {basis, std::move(c)});
    if (RefusalOf([&] { Composed(curve, f); }) != "accepted") continue;
    ++composed;
    const NurbsCurve<3> result = Composed(curve, f);
    const NurbsCurve<3> plain(curve.basis(), curve.control_points());
    if (result.basis() != Composed(plain, f).basis()) ++refined;
    if (curve.rational()) {
      EXPECT_GE(result.weights().minCoeff(), curve.weights().minCoeff() / 16);
    }
    ExpectIsComposition(curve, f, result, random);
    if (HasFailure()) return;
  }
  EXPECT_GT(composed, 1000);
  EXPECT_GT(refined, 0);
}

// A cubic whose coefficients decrease in the middle but whose values do not, on a circle.
TEST(CompositionTest, ACircleStaysExactlyRound) {
  const ScalarSpline f{SplineBasis(3, {0, 0, 0, 0, 1, 1, 1, 1}), Eigen::Vector4d(0, 0.9, 0.1, 1)};
  const NurbsCurve<2> traced = Composed(Circle(1), f);
  EXPECT_EQ(traced.basis().degree(), 6);
  for (double s = 0; s <= 1; s += 1.0 / 64) EXPECT_NEAR(traced.At(s).norm(), 1, kRounding);
  // A double root of f' inside is still an increase.
  const ScalarSpline flat{f.basis, Eigen::Vector4d(0, 1, 0, 1)};
  EXPECT_NEAR(flat.At(0.5), 0.5, kRounding);
  const NurbsCurve<2> slow = Composed(Circle(1), flat);
  for (double s = 0; s <= 1; s += 1.0 / 64) EXPECT_NEAR(slow.At(s).norm(), 1, kRounding);
}

TEST(CompositionTest, WorksFarFromZeroOnTinyDomains) {
  RandomSplines random(5);
  for (int trial = 0; trial < 40; ++trial) {
    SCOPED_TRACE(trial);
    const int p = random.Integer(1, 5), q = random.Integer(1, 5);
    // Spans of 2^-20 at 10^6: doubles there are 2^-33 apart.
    const double step = 0x1p-20, at = 1e6;
    const SplineBasis domain = SplineBasis::Uniform(p, p + 4, at, at + 4 * step);
    const NurbsCurve<2> curve(domain, Eigen::Matrix2Xd::Random(2, domain.size()));
    const SplineBasis basis = SplineBasis::Uniform(q, q + 3, -1e-9, 1e-9);
    const ScalarSpline f = RandomMap(basis, domain, random);
    const NurbsCurve<2> result = Composed(curve, f);
    ExpectIsComposition(curve, f, result, random);
    EXPECT_LE(result.control_points().cwiseAbs().maxCoeff(), 10);
  }
}

TEST(CompositionTest, TheBlossomOfACompositionIsSymmetricAndAffine) {
  RandomSplines random(6);
  for (int trial = 0; trial < 50; ++trial) {
    const int p = random.Integer(1, 5), q = random.Integer(1, 5);
    const SplineBasis outer = random.Basis(p), inner = random.Basis(q);
    const int i = outer.Span(random.Parameter(outer)), j = inner.Span(random.Parameter(inner));
    const double a = outer.knots()[i], b = outer.knots()[i + 1];
    Eigen::VectorXd c(q + 1);
    for (double& x : c) x = random.Real(a, b);
    const auto blossom = [&](const std::vector<double>& arguments) {
      Multiset multiset;
      for (const double x : arguments) {
        multiset.values.push_back(x);
        multiset.counts.push_back(1);
      }
      return ComposedBlossom({p, &outer.knots(), i}, {q, &inner.knots(), j}, c, multiset);
    };
    if (p * q > 6) continue;  // all different arguments cost 2^(p·q)
    std::vector<double> x(p * q);
    for (double& value : x) value = random.Real(inner.knots()[j], inner.knots()[j + 1]);
    const Eigen::VectorXd value = blossom(x);
    EXPECT_NEAR(value.sum(), 1, kRounding);
    std::vector<double> turned = x;
    std::reverse(turned.begin(), turned.end());
    EXPECT_LE((blossom(turned) - value).norm(), kRounding * 100);
    std::vector<double> left = x, right = x;
    left[0] -= 0.1, right[0] += 0.3;
    EXPECT_LE((0.75 * blossom(left) + 0.25 * blossom(right) - value).norm(), kRounding * 100);
  }
}

TEST(CompositionTest, RefusesWhatItCannotDo) {
  const NurbsCurve<2> curve(SplineBasis::Uniform(6, 8, 0, 1), Eigen::Matrix2Xd::Random(2, 8));
  const auto refusal = [&](const ScalarSpline& f) {
    return RefusalOf([&] { Composed(curve, f); });
  };
  const auto polynomial = [](const Eigen::VectorXd& c) {
    const int q = static_cast<int>(c.size()) - 1;
    return ScalarSpline{SplineBasis::Uniform(q, q + 1, 0, 2), c};
  };
  EXPECT_EQ(refusal(polynomial(Eigen::VectorXd::LinSpaced(6, 0, 1))),
            "Composed: the result would have degree 6·5 = 30; at most 25 is possible");
  EXPECT_EQ(refusal(polynomial(Eigen::Vector3d(0, 0.5, 2))),
            "Composed: f maps its domain [0, 2] to [0, 2] and not onto the domain [0, 1]");
  EXPECT_EQ(refusal(polynomial(Eigen::Vector3d(0, 1.5, 1))),
            "Composed: f can't be shown to increase strictly between 0 and 2");
  EXPECT_THAT(refusal(polynomial(Eigen::Vector4d(0, 1.2, -0.2, 1))),
              testing::HasSubstr("can't be shown to increase strictly"));
  EXPECT_THAT(refusal(polynomial(Eigen::Vector3d(0, NAN, 1))), testing::HasSubstr("not finite"));
  EXPECT_THAT(refusal({SplineBasis::Uniform(2, 3, 0, 1), Eigen::Vector2d(0, 1)}),
              testing::HasSubstr("2 coefficients of f do not fit a basis of 3"));
  // Constant on a whole span.
  EXPECT_THAT(refusal({SplineBasis(1, {0, 0, 1, 2, 2}), Eigen::Vector3d(0, 1, 1)}),
              testing::HasSubstr("between 1 and 2"));
  const SplineBasis periodic = SplineBasis::Periodic(1, {-1, 0, 1, 2, 3});
  EXPECT_EQ(refusal({periodic, Eigen::Vector3d(0, 0.4, 1)}), "accepted");
  const SplineBasis smooth = SplineBasis::Periodic(2, {-2, -1, 0, 1, 2, 3, 4});
  EXPECT_THAT(refusal({smooth, Eigen::Vector4d(0, 0.4, 0.6, 1.2)}),
              testing::HasSubstr("over a periodic basis"));
  EXPECT_THAT(
      RefusalOf([&] { Composed(Sphere(1), Direction::kV, polynomial(Eigen::Vector2d(0, 2))); }),
      testing::HasSubstr("not onto the domain"));
}

}  // namespace batten::internal::composition_test
