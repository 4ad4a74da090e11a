// SPDX-License-Identifier: MIT
#include "batten/geometry/spline_basis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "random_splines.h"
#include "tolerances.h"

namespace batten {
namespace {

constexpr int kHighestDegree = 11;

// Calls law(basis, random) for clamped and unclamped bases of every degree up to kHighestDegree.
void ForRandomBases(const std::function<void(const SplineBasis&, RandomSplines&)>& law) {
  for (int degree = 1; degree <= kHighestDegree; ++degree) {
    for (unsigned seed = 0; seed < 20; ++seed) {
      SCOPED_TRACE("degree " + std::to_string(degree) + ", seed " + std::to_string(seed));
      RandomSplines random(1000 * degree + seed);
      const SplineBasis basis = random.Basis(degree, {.clamped = seed % 2 == 0, .most_spans = 7});
      law(basis, random);
      if (testing::Test::HasFailure()) return;
    }
  }
}

std::vector<double> Values(const SplineBasis& basis, int span, double u) {
  std::vector<double> values(basis.degree() + 1);
  basis.Values(span, u, values.data());
  return values;
}

std::vector<double> Derivatives(const SplineBasis& basis, int span, double u, int order) {
  std::vector<double> values((order + 1) * (basis.degree() + 1));
  basis.Derivatives(span, u, order, values.data());
  return values;
}

// N_{i,p}(u) by the recursion of Cox and de Boor, word for word; the upper end of the domain counts
// to the span before it.
double CoxDeBoor(const SplineBasis& basis, int i, int p, double u) {
  const std::vector<double>& U = basis.knots();
  if (p == 0) return i == basis.Span(u) ? 1 : 0;
  const double left = U[i + p] - U[i], right = U[i + p + 1] - U[i + 1];
  return (left > 0 ? (u - U[i]) / left * CoxDeBoor(basis, i, p - 1, u) : 0) +
         (right > 0 ? (U[i + p + 1] - u) / right * CoxDeBoor(basis, i + 1, p - 1, u) : 0);
}

std::string Refusal(int degree, std::vector<double> knots) {
  try {
    const SplineBasis basis(degree, std::move(knots));
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(SplineBasisTest, SumsToOneOnTheClosedDomain) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines& random) {
    for (int trial = 0; trial < 20; ++trial) {
      const double u = random.Parameter(basis);
      double sum = 0;
      for (const double value : Values(basis, basis.Span(u), u)) sum += value;
      EXPECT_NEAR(sum, 1, kRounding) << "u = " << u;
    }
  });
}

TEST(SplineBasisTest, IsNowhereNegative) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines& random) {
    for (int trial = 0; trial < 20; ++trial) {
      const double u = random.Parameter(basis);
      EXPECT_THAT(Values(basis, basis.Span(u), u), testing::Each(testing::Ge(0.0))) << "u = " << u;
    }
  });
}

TEST(SplineBasisTest, VanishesOutsideItsSupportAndEqualsTheRecursionInside) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines& random) {
    if (basis.degree() > 7) return;  // the plain recursion costs 2^p
    for (int trial = 0; trial < 5; ++trial) {
      const double u = random.Parameter(basis);
      const int span = basis.Span(u), p = basis.degree();
      const std::vector<double> values = Values(basis, span, u);
      for (int i = 0; i < basis.size(); ++i) {
        const bool reached = span - p <= i && i <= span;
        EXPECT_NEAR(CoxDeBoor(basis, i, p, u), reached ? values[i - span + p] : 0, kRounding)
            << "N_" << i << " at " << u;
        if (u < basis.knots()[i] || u > basis.knots()[i + p + 1]) {
          EXPECT_FALSE(reached);
        }
      }
    }
  });
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
    EXPECT_EQ(basis.Clamp(-infinity), basis.lower());
    EXPECT_EQ(basis.Clamp(infinity), basis.upper());
  });
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

TEST(SplineBasisTest, DerivativesOfOrderZeroAreTheValues) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines& random) {
    const double u = random.Parameter(basis);
    const int span = basis.Span(u);
    const std::vector<double> values = Values(basis, span, u);
    const std::vector<double> derivatives = Derivatives(basis, span, u, 0);
    for (int r = 0; r <= basis.degree(); ++r) EXPECT_NEAR(derivatives[r], values[r], kRounding);
  });
}

TEST(SplineBasisTest, DerivativesSumToZero) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines& random) {
    const double u = random.Parameter(basis);
    const int p = basis.degree();
    const std::vector<double> values = Derivatives(basis, basis.Span(u), u, p);
    for (int k = 1; k <= p; ++k) {
      double sum = 0, size = 0;
      for (int r = 0; r <= p; ++r) {
        sum += values[k * (p + 1) + r];
        size += std::abs(values[k * (p + 1) + r]);
      }
      EXPECT_NEAR(sum, 0, kRounding * size) << "order " << k << " at " << u;
    }
  });
}

TEST(SplineBasisTest, DerivativesAreTheLimitsOfDifferences) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines& random) {
    const int p = basis.degree();
    for (const int span : basis.Spans()) {
      const double length = basis.knots()[span + 1] - basis.knots()[span];
      const double u = basis.knots()[span] + random.Real(0.2, 0.8) * length;
      const std::vector<double> exact = Derivatives(basis, span, u, p);
      // Richardson's extrapolation of central differences: error O(h⁴).
      const double h = 2e-3 * length;
      const auto plus = Derivatives(basis, span, u + h, p);
      const auto minus = Derivatives(basis, span, u - h, p);
      const auto plus_half = Derivatives(basis, span, u + h / 2, p);
      const auto minus_half = Derivatives(basis, span, u - h / 2, p);
      for (int k = 1; k <= p; ++k) {
        double size = 0;
        for (int r = 0; r <= p; ++r) {
          const int j = k * (p + 1) + r;
          size = std::max({size, std::abs(exact[j]), std::abs(exact[j - p - 1]) / length});
        }
        for (int r = 0; r <= p; ++r) {
          const int j = (k - 1) * (p + 1) + r;
          const double difference =
              (4 * (plus_half[j] - minus_half[j]) / h - (plus[j] - minus[j]) / (2 * h)) / 3;
          EXPECT_NEAR(exact[k * (p + 1) + r], difference, kHalfDigits * size)
              << "order " << k << ", function " << r << " of span " << span;
        }
      }
    }
  });
}

TEST(SplineBasisTest, DerivativesAboveTheDegreeVanish) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines& random) {
    const double u = random.Parameter(basis);
    const int p = basis.degree();
    const std::vector<double> values = Derivatives(basis, basis.Span(u), u, p + 2);
    for (int j = (p + 1) * (p + 1); j < (p + 3) * (p + 1); ++j) EXPECT_EQ(values[j], 0);
  });
}

TEST(SplineBasisTest, GrevilleAbscissaeReproduceTheParameter) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines& random) {
    for (int trial = 0; trial < 10; ++trial) {
      const double u = random.Parameter(basis);
      const int span = basis.Span(u), p = basis.degree();
      const std::vector<double> values = Values(basis, span, u);
      double sum = 0, size = 1;
      for (int r = 0; r <= p; ++r) {
        const double abscissa = basis.Greville(span - p + r);
        sum += values[r] * abscissa;
        size = std::max(size, std::abs(abscissa));
      }
      EXPECT_NEAR(sum, u, kRounding * size);
    }
  });
}

TEST(SplineBasisTest, ScalingAndShiftingTheKnotsChangesNoValue) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines& random) {
    for (const double scale : {1e-9, 1e9}) {
      std::vector<double> knots = basis.knots();
      for (double& knot : knots) knot *= scale;
      const SplineBasis scaled(basis.degree(), knots);
      const double u = random.Real(basis.lower(), basis.upper());
      const int span = basis.Span(u), p = basis.degree();
      const std::vector<double> expected = Derivatives(basis, span, u, 1);
      const std::vector<double> actual = Derivatives(scaled, span, scale * u, 1);
      for (int r = 0; r <= p; ++r) {
        EXPECT_NEAR(actual[r], expected[r], kRounding);
        EXPECT_NEAR(actual[p + 1 + r] * scale,
                    expected[p + 1 + r],
                    kRounding * p / (basis.knots()[span + 1] - basis.knots()[span]));
      }
    }
  });
}

TEST(SplineBasisTest, HighestDegreeSumsToOne) {
  const SplineBasis basis = SplineBasis::Uniform(kMaxDegree, kMaxDegree + 6, -1, 2);
  for (const double u : {-1.0, -0.3, 0.5, 1.99, 2.0}) {
    const std::vector<double> values = Derivatives(basis, basis.Span(u), u, kMaxDegree + 1);
    double sum = 0;
    for (int r = 0; r <= kMaxDegree; ++r) {
      EXPECT_GE(values[r], 0);
      sum += values[r];
    }
    EXPECT_NEAR(sum, 1, kRounding);
  }
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

}  // namespace
}  // namespace batten
