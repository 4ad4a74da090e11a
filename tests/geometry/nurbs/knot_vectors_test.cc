// SPDX-License-Identifier: MIT
#include "batten/geometry/knot_vectors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "law_cases.h"
#include "random_splines.h"
#include "shape_edits.h"

namespace batten::internal::knot_vectors_test {

using Knots = std::vector<double>;

std::vector<double> RandomParameters(RandomSplines& random, int count, bool repeated) {
  std::vector<double> t(1, random.Real(-5, 5));
  while (static_cast<int>(t.size()) < count) {
    const bool again = repeated && random.Integer(0, 3) == 0;
    t.push_back(again ? t.back() : t.back() + random.Logarithmic(1e-3, 1));
  }
  return t;
}

// Schoenberg and Whitney: to every function a parameter of its own, in order, where it does not
// vanish. Taking the first that serves is best, since the supports are in order too.
bool HasFullRank(const SplineBasis& basis, const std::vector<double>& t) {
  size_t k = 0;
  for (int i = 0; i < basis.size(); ++i) {
    while (k < t.size() && !(basis.Function(i, t[k]) > 0)) ++k;
    if (k == t.size()) return false;
    const double used = t[k];
    while (k < t.size() && t[k] == used) ++k;
  }
  return true;
}

// How many parameters are in each span; one at a knot counts above it, the last below.
std::vector<int> CountsInSpans(const SplineBasis& basis, const std::vector<double>& t) {
  std::vector<int> counts;
  for (const int span : basis.Spans()) {
    counts.push_back(static_cast<int>(
        std::count_if(t.begin(), t.end(), [&](double u) { return basis.Span(u) == span; })));
  }
  return counts;
}

TEST(KnotVectorsTest, UniformKnotsAreEquallySpacedEverywhere) {
  for (int p = 1; p <= 11; ++p) {
    const SplineBasis basis = UniformKnots(p, p + 6, -3, 7.5);
    EXPECT_EQ(basis.lower(), -3);
    EXPECT_EQ(basis.upper(), 7.5);
    for (size_t i = 1; i < basis.knots().size(); ++i) {
      EXPECT_NEAR(basis.knots()[i] - basis.knots()[i - 1], 10.5 / 6, 64 * kUnitRoundoff);
    }
  }
}

TEST(KnotVectorsTest, QuasiUniformKnotsAreClampedWithEqualSpans) {
  EXPECT_EQ(QuasiUniformKnots(3, 7, 0, 4).knots(), (Knots{0, 0, 0, 0, 1, 2, 3, 4, 4, 4, 4}));
}

TEST(KnotVectorsTest, PeriodicKnotsRepeatTheBreaks) {
  const SplineBasis basis = PeriodicKnots(2, Knots{0, 1, 1, 3, 4});
  EXPECT_TRUE(basis.periodic());
  EXPECT_EQ(basis.knots(), (Knots{-3, -1, 0, 1, 1, 3, 4, 5, 5}));
  for (int p = 1; p <= 11; ++p) {
    for (int m = 1; m <= 9; ++m) {
      const SplineBasis uniform = PeriodicUniformKnots(p, m, 0.1, 0.7);
      EXPECT_EQ(uniform.size(), m + p);
      EXPECT_EQ(uniform.lower(), 0.1);
      EXPECT_EQ(uniform.upper(), 0.7);
    }
  }
  // A seam of full multiplicity, met exactly from both sides.
  const SplineBasis seam = PeriodicKnots(3, Knots{0.1, 0.4, 0.7, 0.7, 0.7});
  EXPECT_EQ(seam.Multiplicity(0.1), 3);
  EXPECT_EQ(seam.Multiplicity(0.7), 3);
}

// [Piegl & Tiller 1997, example 9.1]
TEST(KnotVectorsTest, AveragedKnotsAreThoseOfTheBook) {
  const SplineBasis basis = AveragedKnots(3, Knots{0, 5. / 17, 9. / 17, 14. / 17, 1});
  const Knots wanted{0, 0, 0, 0, 28. / 51, 1, 1, 1, 1};
  ASSERT_EQ(basis.knots().size(), wanted.size());
  for (size_t i = 0; i < wanted.size(); ++i) {
    EXPECT_NEAR(basis.knots()[i], wanted[i], kUnitRoundoff);
  }
}

TEST(KnotVectorsTest, AveragedKnotsMakeInterpolationSolvable) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int p = random.Integer(1, 11);
    const auto t = RandomParameters(random, p + random.Integer(1, 30), false);
    const SplineBasis basis = AveragedKnots(p, t);
    ASSERT_EQ(basis.size(), std::ssize(t));
    EXPECT_EQ(basis.lower(), t.front());
    EXPECT_EQ(basis.upper(), t.back());
    // Schoenberg and Whitney: every parameter is where its own function does not vanish.
    for (int i = 0; i < basis.size(); ++i) EXPECT_GT(basis.Function(i, t[i]), 0);
  }
}

TEST(KnotVectorsTest, LeastSquaresKnotsFollowTheFormulaOfTheBook) {
  // m + 1 = 10 parameters, n + 1 = 6 functions, p = 3: d = 10/3; knots at 3.33 and 6.67.
  Knots t;
  for (int k = 0; k < 10; ++k) t.push_back(k * k);
  const SplineBasis basis = LeastSquaresKnots(3, 6, t);
  EXPECT_NEAR(basis.knots()[4], (2. / 3) * 4 + (1. / 3) * 9, 1e-15 * 9);
  EXPECT_NEAR(basis.knots()[5], (1. / 3) * 25 + (2. / 3) * 36, 1e-15 * 36);
}

TEST(KnotVectorsTest, LeastSquaresKnotsLeaveNoSpanEmpty) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int p = random.Integer(1, 7), size = p + random.Integer(1, 20);
    const auto t = RandomParameters(random, size + random.Integer(0, 40), false);
    const SplineBasis basis = LeastSquaresKnots(p, size, t);
    ASSERT_EQ(basis.size(), size);
    for (const int count : CountsInSpans(basis, t)) EXPECT_GT(count, 0);
    EXPECT_TRUE(HasFullRank(basis, t));
  }
}

TEST(KnotVectorsTest, DensityKnotsLeaveNoSpanEmptyAndLeastSquaresSolvable) {
  for (unsigned seed = 0; seed < 400; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int p = random.Integer(1, 7), size = p + random.Integer(1, 20);
    std::vector<double> t = RandomParameters(random, size + random.Integer(0, 40), false);
    // Parameters that repeat up to a hundred times.
    for (int k = random.Integer(0, 5); k > 0; --k) {
      const double again = AnyOf(t, random);
      t.insert(t.end(), random.Integer(1, 100), again);
    }
    std::sort(t.begin(), t.end());
    const SplineBasis basis = DensityKnots(p, size, t);
    ASSERT_EQ(basis.size(), size);
    for (const int count : CountsInSpans(basis, t)) EXPECT_GT(count, 0);
    for (const auto& [knot, multiplicity] : DomainKnots(basis)) {
      const bool inner = knot > basis.lower() && knot < basis.upper();
      EXPECT_EQ(multiplicity, inner ? 1 : p + 1);
    }
    EXPECT_TRUE(HasFullRank(basis, t));
  }
}

TEST(KnotVectorsTest, DensityKnotsShareParametersEvenly) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int p = random.Integer(1, 7), spans = random.Integer(1, 20);
    const int count = random.Integer(p + spans, 400);
    const auto t = RandomParameters(random, count, false);
    const auto counts = CountsInSpans(DensityKnots(p, p + spans, t), t);
    EXPECT_LE(*std::max_element(counts.begin(), counts.end()) -
                  *std::min_element(counts.begin(), counts.end()),
              1);
  }
}

TEST(KnotVectorsTest, RiesenfeldKnotsAreVerticesForOddAndMiddlesOfEdgesForEvenDegree) {
  // Edges of length 1, 2, 3, 4, 5, 5: twenty in all.
  const Eigen::Matrix2Xd polygon{{0, 1, 1, 4, 4, 9, 9}, {0, 0, 2, 2, 6, 6, 1}};
  EXPECT_EQ(RiesenfeldKnots(1, polygon).knots(),
            (Knots{0, 0, 1. / 20, 3. / 20, 6. / 20, 10. / 20, 15. / 20, 1, 1}));
  EXPECT_EQ(RiesenfeldKnots(2, polygon).knots(),
            (Knots{0, 0, 0, 2. / 20, 4.5 / 20, 8. / 20, 12.5 / 20, 1, 1, 1}));
  EXPECT_EQ(RiesenfeldKnots(3, polygon).knots(),
            (Knots{0, 0, 0, 0, 3. / 20, 6. / 20, 10. / 20, 1, 1, 1, 1}));
  EXPECT_EQ(RiesenfeldKnots(4, polygon).knots(),
            (Knots{0, 0, 0, 0, 0, 4.5 / 20, 8. / 20, 1, 1, 1, 1, 1}));
  EXPECT_EQ(RiesenfeldKnots(5, polygon).knots(),
            (Knots{0, 0, 0, 0, 0, 0, 6. / 20, 1, 1, 1, 1, 1, 1}));
  EXPECT_EQ(RiesenfeldKnots(6, polygon).knots(), SplineBasis::Uniform(6, 7, 0, 1).knots());
}

TEST(KnotVectorsTest, RiesenfeldKnotsOfCoincidentVerticesRepeatOrAreRefused) {
  const Eigen::Matrix2Xd twice{{0, 1, 2, 2, 3, 4}, {0, 0, 0, 0, 0, 0}};
  EXPECT_EQ(RiesenfeldKnots(3, twice).knots(), (Knots{0, 0, 0, 0, 0.5, 0.5, 1, 1, 1, 1}));
  EXPECT_NE(RefusalOf([&] { RiesenfeldKnots(1, twice); }), "accepted");
  const Eigen::Matrix2Xd at_start{{0, 0, 0, 1, 2}, {0, 0, 0, 0, 0}};
  EXPECT_NE(RefusalOf([&] { RiesenfeldKnots(3, at_start); }), "accepted");
  EXPECT_NE(RefusalOf([&] { RiesenfeldKnots(2, Eigen::Matrix2Xd::Zero(2, 4)); }), "accepted");
}

TEST(KnotVectorsTest, ScaledKnotsKeepTheFunctions) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines& random) {
    const double a = random.Real(-10, 10), b = a + random.Logarithmic(1e-3, 1e3);
    const SplineBasis scaled = Scaled(basis, a, b);
    EXPECT_EQ(scaled.lower(), a);
    EXPECT_EQ(scaled.upper(), b);
    EXPECT_EQ(scaled.periodic(), basis.periodic());
    EXPECT_EQ(scaled.clamped(), basis.clamped());
    for (const auto& [knot, multiplicity] : DomainKnots(basis)) {
      const double there = a + (knot - basis.lower()) / (basis.upper() - basis.lower()) * (b - a);
      const bool found = std::any_of(scaled.knots().begin(), scaled.knots().end(), [&](double u) {
        return std::abs(u - there) <= 8 * kUnitRoundoff * DomainExtent(scaled) &&
               scaled.Multiplicity(u) == multiplicity;
      });
      EXPECT_TRUE(found) << knot;
    }
    // The value of a function moves by its slope times the rounding of the knots.
    const double t = random.Real(0, 1);
    double here[kMaxDegree + 1], there[kMaxDegree + 1];
    const double u = basis.lower() + t * (basis.upper() - basis.lower()), v = a + t * (b - a);
    if (basis.Span(u) != scaled.Span(v)) return;
    basis.Values(basis.Span(u), u, here);
    scaled.Values(scaled.Span(v), v, there);
    const double slope = 2 * basis.degree() *
                         std::max(DomainExtent(basis) / ShortestSpan(basis),
                                  DomainExtent(scaled) / ShortestSpan(scaled));
    for (int r = 0; r <= basis.degree(); ++r)
      EXPECT_NEAR(here[r], there[r], 16 * kUnitRoundoff * slope);
  });
}

TEST(KnotVectorsTest, ReversedKnotsTurnTheFunctionsRound) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines& random) {
    const SplineBasis back = Reversed(basis);
    EXPECT_EQ(back.lower(), basis.lower());
    EXPECT_EQ(back.upper(), basis.upper());
    EXPECT_EQ(back.periodic(), basis.periodic());
    const double u = random.Real(basis.lower(), basis.upper());
    const double v = basis.lower() + (basis.upper() - u);
    const double slope = 2 * basis.degree() * DomainExtent(basis) / ShortestSpan(basis);
    for (int i = 0; i < basis.size(); ++i) {
      EXPECT_NEAR(
          basis.Function(i, u), back.Function(basis.size() - 1 - i, v), 16 * kUnitRoundoff * slope);
    }
  });
}

TEST(KnotVectorsTest, DistinctKnotsCountMultiplicities) {
  const Knots knots{0, 0, 0, 0.5, 0.5 + 1e-9, 1, 1, 1};
  EXPECT_EQ(DistinctKnots(knots),
            (std::vector<KnotMultiplicity>{{0, 3}, {0.5, 1}, {0.5 + 1e-9, 1}, {1, 3}}));
  EXPECT_EQ(DistinctKnots(knots, 1e-6), (std::vector<KnotMultiplicity>{{0, 3}, {0.5, 2}, {1, 3}}));
  EXPECT_TRUE(DistinctKnots({}).empty());
  const SplineBasis open(2, {-1, 0, 0, 0.5, 1, 2, 2});
  EXPECT_EQ(DomainKnots(open), (std::vector<KnotMultiplicity>{{0, 2}, {0.5, 1}, {1, 1}}));
}

TEST(KnotVectorsTest, SameKnotsAreEqualWithinTheTolerance) {
  const SplineBasis a(2, {0, 0, 0, 0.5, 1, 1, 1}), b(2, {0, 0, 0, 0.5 + 1e-9, 1, 1, 1});
  EXPECT_TRUE(SameKnots(a, b, 1e-8));
  EXPECT_FALSE(SameKnots(a, b, 1e-10));
  EXPECT_FALSE(SameKnots(a, b, 0));
  EXPECT_TRUE(SameKnots(a, a, 0));
  EXPECT_FALSE(SameKnots(a, SplineBasis(2, {0, 0, 0, 1, 1, 1}), 1));
  const SplineBasis open(1, {-1, 0, 1, 2});
  EXPECT_FALSE(SameKnots(open, SplineBasis::Periodic(1, {-1, 0, 1, 2}), 1));
}

TEST(KnotVectorsTest, MissingKnotsCompleteABasis) {
  const SplineBasis a(3, {0, 0, 0, 0, 0.2, 0.5, 1, 1, 1, 1});
  const SplineBasis b(3, {-1, 0, 0, 0, 0.5, 0.5, 0.7, 1, 1, 1, 2});
  EXPECT_EQ(MissingKnots(a, b), (Knots{0.5, 0.7}));
  EXPECT_EQ(MissingKnots(b, a), (Knots{0.2}));
  EXPECT_TRUE(MissingKnots(a, a).empty());
}

TEST(KnotVectorsTest, RefusesWhatCannotBe) {
  EXPECT_EQ(RefusalOf([] { UniformKnots(3, 3, 0, 1); }),
            "UniformKnots: 3 functions are too few for degree 3: more than the degree are needed");
  EXPECT_EQ(RefusalOf([] { UniformKnots(26, 30, 0, 1); }),
            "UniformKnots: degree 26 is not in [1, 25]");
  EXPECT_EQ(RefusalOf([] { UniformKnots(0, 30, 0, 1); }),
            "UniformKnots: degree 0 is not in [1, 25]");
  EXPECT_NE(RefusalOf([] { QuasiUniformKnots(3, 6, 1, 1); }), "accepted");
  EXPECT_NE(RefusalOf([] { QuasiUniformKnots(3, 6, std::nan(""), 1); }), "accepted");
  EXPECT_NE(RefusalOf([] { PeriodicKnots(3, Knots{1}); }), "accepted");
  EXPECT_NE(RefusalOf([] { PeriodicKnots(3, Knots{1, 0.5, 2}); }), "accepted");
  EXPECT_NE(RefusalOf([] { PeriodicUniformKnots(3, 0, 0, 1); }), "accepted");
  EXPECT_NE(RefusalOf([] { AveragedKnots(3, Knots{0, 1, 2}); }), "accepted");
  EXPECT_NE(RefusalOf([] { AveragedKnots(1, Knots{0, 2, 1}); }), "accepted");
  EXPECT_NE(RefusalOf([] { AveragedKnots(1, Knots{0, std::nan(""), 1}); }), "accepted");
  EXPECT_NE(RefusalOf([] { AveragedKnots(1, Knots{1, 1, 1}); }), "accepted");
  EXPECT_NE(RefusalOf([] { LeastSquaresKnots(1, 4, Knots{0, 1, 2}); }), "accepted");
  EXPECT_EQ(RefusalOf([] {
              DensityKnots(1, 4, Knots{0, 1, 1, 1, 2});
            }),
            "DensityKnots: 4 functions are more than the 3 different parameters");
  EXPECT_NE(RefusalOf([] { Scaled(UniformKnots(1, 3, 0, 1), 1, 1); }), "accepted");
  EXPECT_NE(RefusalOf([] { DistinctKnots(Knots{1, 2}, -1); }), "accepted");
}

}  // namespace batten::internal::knot_vectors_test
