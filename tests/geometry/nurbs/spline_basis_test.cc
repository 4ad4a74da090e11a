// SPDX-License-Identifier: MIT
#include "batten/geometry/spline_basis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "law_cases.h"
#include "tolerances.h"
#include "refusal.h"

namespace batten::internal::spline_basis_test {

std::string Refusal(int degree, std::vector<double> knots) {
  return internal::RefusalOf([&] { const SplineBasis basis(degree, std::move(knots)); });
}

TEST(SplineBasisTest, SpanContainsItsParameter) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines& random) {
    for (int trial = 0; trial < 20; ++trial) {
      const double u = random.Parameter(basis);
      const int span = basis.Span(u);
      ASSERT_GE(span, basis.degree());
      ASSERT_LT(span, basis.size());
      EXPECT_LT(basis.knots()[span], basis.knots()[span + 1]);
      EXPECT_LE(basis.knots()[span], u);
      if (u < basis.upper()) {
        EXPECT_LT(u, basis.knots()[span + 1]);
      } else {
        EXPECT_EQ(u, basis.knots()[span + 1]);
      }
    }
  });
}

TEST(SplineBasisTest, SpanOutsideTheDomainIsThatOfTheNearestEnd) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines&) {
    const double infinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(basis.Span(basis.lower() - 1), basis.Span(basis.lower()));
    EXPECT_EQ(basis.Span(-infinity), basis.Span(basis.lower()));
    EXPECT_EQ(basis.Span(basis.upper() + 1), basis.Span(basis.upper()));
    EXPECT_EQ(basis.Span(infinity), basis.Span(basis.upper()));
    if (basis.periodic()) return;  // periodic_test.cc
    EXPECT_EQ(basis.Clamp(-infinity), basis.lower());
    EXPECT_EQ(basis.Clamp(infinity), basis.upper());
  });
}

// The span is guessed from even knots: here they are as uneven as they come.
TEST(SplineBasisTest, SpanIsRightHoweverUnevenTheKnots) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int degree = random.Integer(1, 5);
    std::vector<double> knots(1, random.Real(-1, 1));
    for (int i = random.Integer(2 * degree + 2, 120); i > 0; --i) {
      const double next = knots.back() + random.Logarithmic(1e-13, seed % 2 == 0 ? 1 : 1e9);
      knots.push_back(std::max(next, std::nextafter(knots.back(), 1e300)));
    }
    const SplineBasis basis(degree, knots);
    for (int i = degree; i < basis.size(); ++i) {
      EXPECT_EQ(basis.Span(knots[i]), i);
      EXPECT_EQ(basis.Span(std::nextafter(knots[i + 1], knots[i])), i);
      const double u = random.Real(basis.lower(), basis.upper());
      const auto next = std::upper_bound(knots.begin(), knots.end(), u);
      EXPECT_EQ(basis.Span(u), next - knots.begin() - 1) << "u = " << u;
    }
  }
}

TEST(SplineBasisTest, RefusesAParameterThatIsNotANumber) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines&) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(basis.Span(nan), std::invalid_argument);
    EXPECT_THROW(basis.Clamp(nan), std::invalid_argument);
    EXPECT_THROW(basis.Function(0, nan), std::invalid_argument);
  });
}

TEST(SplineBasisTest, RefusesFunctionsItDoesNotHave) {
  const SplineBasis basis(2, {0, 0, 0, 1, 1, 1});
  for (const int i : {-1, 3, 1 << 30}) {
    EXPECT_THROW(basis.Function(i, 0.5), std::invalid_argument) << i;
    EXPECT_THROW(basis.FunctionDerivatives(i, 0.5, 1), std::invalid_argument) << i;
  }
  EXPECT_THROW(basis.FunctionDerivatives(1, 0.5, -1), std::invalid_argument);
}

TEST(SplineBasisTest, FunctionTakesParametersOutsideTheDomainAsClampDoes) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines&) {
    const double outside = basis.upper() + 0.3;
    for (int i = 0; i < basis.size(); ++i) {
      EXPECT_EQ(basis.Function(i, outside), basis.Function(i, basis.Clamp(outside)));
      EXPECT_EQ(basis.FunctionDerivatives(i, outside, 2),
                basis.FunctionDerivatives(i, basis.Clamp(outside), 2));
    }
  });
}

TEST(SplineBasisTest, GrevilleAbscissaeAreExactWhereKnotsCoincide) {
  for (int degree = 1; degree <= kMaxDegree; ++degree) {
    const SplineBasis basis = SplineBasis::Uniform(degree, degree + 5, 0.1, 0.7);
    EXPECT_EQ(basis.Greville(0), 0.1);
    EXPECT_EQ(basis.Greville(degree + 4), 0.7);
  }
  const double large = 1.7e308;
  EXPECT_EQ(SplineBasis(3, {0, 0, 0, 0, large, large, large, large}).Greville(3), large);
}

TEST(SplineBasisTest, SpanAtARepeatedKnotIsTheOneAfterIt) {
  const SplineBasis basis(2, {0, 0, 0, 1, 2, 3, 4, 4, 5, 5, 5});
  EXPECT_EQ(basis.Span(0), 2);
  EXPECT_EQ(basis.Span(1), 3);
  EXPECT_EQ(basis.Span(std::nextafter(4.0, 0)), 5);
  EXPECT_EQ(basis.Span(4), 7);
  EXPECT_EQ(basis.Span(5), 7);
}

TEST(SplineBasisTest, SpanAtTheUpperEndOfAnUnclampedDomainLiesInside) {
  const SplineBasis basis(2, {-2, -1, 0, 1, 1, 2, 3, 4});
  EXPECT_EQ(basis.upper(), 2);
  EXPECT_EQ(basis.Span(2), 4);
  EXPECT_EQ(basis.Span(1), 4);
  EXPECT_EQ(basis.Span(0), 2);
}

TEST(SplineBasisTest, SpansAreExactlyTheNonEmptyOnesOfTheDomain) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines&) {
    double reached = basis.lower();
    for (const int span : basis.Spans()) {
      EXPECT_EQ(basis.knots()[span], reached);
      reached = basis.knots()[span + 1];
      EXPECT_EQ(basis.Span((basis.knots()[span] + reached) / 2), span);
    }
    EXPECT_EQ(reached, basis.upper());
  });
}

TEST(SplineBasisTest, AcceptsTheLargestMultiplicities) {
  for (int p = 1; p <= kMaxDegree; ++p) {
    std::vector<double> knots(p + 1, 0.0);
    knots.insert(knots.end(), p, 0.5);
    knots.insert(knots.end(), p + 1, 1.0);
    const SplineBasis basis(p, knots);
    EXPECT_EQ(basis.size(), 2 * p + 1);
    EXPECT_EQ(basis.Multiplicity(0), p + 1);
    EXPECT_EQ(basis.Multiplicity(0.5), p);
    EXPECT_EQ(basis.Multiplicity(0.25), 0);
  }
}

TEST(SplineBasisTest, RefusesDegreesOutsideItsRange) {
  for (const int degree : {-1000, -1, 0, kMaxDegree + 1, 1 << 30}) {
    EXPECT_THAT(Refusal(degree, std::vector<double>(60, 0.0)),
                testing::HasSubstr("degree " + std::to_string(degree) + " is not in [1, 25]"));
  }
}

TEST(SplineBasisTest, RefusesDegreesOutsideItsRangeInEveryFactory) {
  const std::vector<double> breaks{0, 1};
  for (const int degree : {-1000, -1, 0, kMaxDegree + 1}) {
    EXPECT_THROW(SplineBasis::Clamped(degree, breaks), std::invalid_argument) << degree;
    EXPECT_THROW(SplineBasis::Uniform(degree, 100, 0, 1), std::invalid_argument) << degree;
  }
}

TEST(SplineBasisTest, RefusesTooFewKnots) {
  EXPECT_THAT(Refusal(3, {}), testing::HasSubstr("0 knots are too few for degree 3"));
  EXPECT_THAT(Refusal(3, {0, 0, 0, 0, 1, 1, 1}),
              testing::HasSubstr("7 knots are too few for degree 3: at least 8"));
}

TEST(SplineBasisTest, RefusesADecreasingKnotAndNamesIt) {
  EXPECT_THAT(Refusal(2, {0, 0, 0, 0.7, 0.6, 1, 1, 1}), testing::HasSubstr("knot 4 decreases"));
}

TEST(SplineBasisTest, RefusesAKnotThatIsNotFinite) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_THAT(Refusal(1, {0, 0, std::nan(""), 1, 1}), testing::HasSubstr("knot 2 is not finite"));
  EXPECT_THAT(Refusal(1, {0, 0, 1, infinity}), testing::HasSubstr("knot 3 is not finite"));
  EXPECT_THAT(Refusal(1, {-infinity, 0, 1, 1}), testing::HasSubstr("knot 0 is not finite"));
}

// Every value divides by differences of knots.
TEST(SplineBasisTest, RefusesDifferencesThatADoubleCannotDivideBy) {
  EXPECT_THAT(Refusal(1, {-1e308, -1e308, 1e308, 1e308}), testing::HasSubstr("farther apart"));
  EXPECT_THAT(Refusal(1, {-1e308, 0, 1, 1e308}), testing::HasSubstr("farther apart"));
  EXPECT_THAT(Refusal(1, {0, 0, 1e-310, 1, 1}), testing::HasSubstr("knots 1 and 2 differ by less"));
  EXPECT_THAT(Refusal(1, {0, 0, 5e-324, 5e-324}), testing::HasSubstr("smallest normal double"));
  EXPECT_THROW(SplineBasis::Uniform(3, 10, -1e308, 1e308), std::invalid_argument);
  EXPECT_THROW(SplineBasis::Clamped(3, std::vector<double>{-1e308, 1e308}), std::invalid_argument);
  EXPECT_THROW(SplineBasis::Uniform(3, 10, std::nan(""), 1), std::invalid_argument);

  for (const double length : {std::numeric_limits<double>::min(), 1e308}) {
    const SplineBasis basis(2, {0, 0, 0, length, length, length});
    double values[3];
    basis.Values(basis.Span(length / 2), length / 2, values);
    EXPECT_NEAR(values[0], 0.25, kRounding);
    EXPECT_NEAR(values[1], 0.5, kRounding);
    EXPECT_NEAR(values[2], 0.25, kRounding);
  }
}

TEST(SplineBasisTest, MessagesShowNumbersInFull) {
  EXPECT_THAT(Refusal(1, {0, 0, 1e-12, 1e-12, 1, 1}), testing::HasSubstr("knot 1e-12 is repeated"));
  EXPECT_THAT(Refusal(1, {0, 0, 2.5e-13, 1e-13, 1}), testing::HasSubstr("(2.5e-13 to 1e-13)"));
}

TEST(SplineBasisTest, RefusesAnEmptyDomain) {
  EXPECT_THAT(Refusal(1, {0, 0, 0, 0}), testing::HasSubstr("domain is empty"));
  EXPECT_THAT(Refusal(2, {0, 0, 1, 1, 2, 2}), testing::HasSubstr("domain is empty"));
}

TEST(SplineBasisTest, RefusesTooHighMultiplicities) {
  EXPECT_THAT(Refusal(2, {0, 0, 0, 0.5, 0.5, 0.5, 1, 1, 1}), testing::HasSubstr("3 times"));
  EXPECT_THAT(Refusal(2, {0, 0, 0, 0, 1, 1, 1}), testing::HasSubstr("4 times"));
  EXPECT_THAT(Refusal(2, {0, 0, 0, 1, 1, 1, 1}), testing::HasSubstr("4 times"));
}

TEST(SplineBasisTest, RefusesBreaksThatDoNotIncrease) {
  EXPECT_THROW(SplineBasis::Clamped(2, std::vector<double>{}), std::invalid_argument);
  EXPECT_THROW(SplineBasis::Clamped(2, std::vector<double>{1}), std::invalid_argument);
  EXPECT_THROW(SplineBasis::Clamped(2, std::vector<double>{1, 0}), std::invalid_argument);
  EXPECT_THROW(SplineBasis::Uniform(2, 5, 1, 1), std::invalid_argument);
  EXPECT_THROW(SplineBasis::Uniform(2, 2, 0, 1), std::invalid_argument);
}

TEST(SplineBasisTest, UniformHasEqualSpansAndExactEnds) {
  const SplineBasis basis = SplineBasis::Uniform(3, 13, 0.1, 0.7);
  EXPECT_EQ(basis.size(), 13);
  EXPECT_EQ(basis.lower(), 0.1);
  EXPECT_EQ(basis.upper(), 0.7);
  for (const int span : basis.Spans()) {
    EXPECT_NEAR(basis.knots()[span + 1] - basis.knots()[span], 0.06, kRounding);
  }
}

TEST(SplineBasisTest, EqualMeansSameDegreeAndKnots) {
  EXPECT_EQ(SplineBasis(1, {0, 0, 1, 1}), SplineBasis::Uniform(1, 2, 0, 1));
  EXPECT_NE(SplineBasis(1, {0, 0, 1, 1}), SplineBasis(1, {0, 0, 2, 2}));
}

}  // namespace batten::internal::spline_basis_test
