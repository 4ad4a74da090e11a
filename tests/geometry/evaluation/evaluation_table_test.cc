// SPDX-License-Identifier: MIT
#include "geometry/evaluation/evaluation_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "geometry/evaluation/evaluation_lanes.h"
#include "law_cases.h"

namespace batten::internal::evaluation_table_test {

void ExpectSameSpan(const SplineBasis& basis, const AxisTable& table, double u) {
  const lanes::Place place = lanes::Locate(table, u);
  const double inside = basis.Clamp(u);
  ASSERT_EQ(table.first_point[place.span], basis.Span(inside) - basis.degree()) << u;
  EXPECT_GE(place.t, 0);
  EXPECT_GE(place.o, 0);
  EXPECT_NEAR(place.t + place.o, 1, 4e-16);
}

// Every knot, its two neighbours, and places between.
void ExpectSpansOf(const SplineBasis& basis, RandomSplines& random) {
  const AxisStorage axis(basis, 0);
  for (double knot : basis.knots()) {
    ExpectSameSpan(basis, axis.table(), knot);
    ExpectSameSpan(basis, axis.table(), std::nextafter(knot, 1e300));
    ExpectSameSpan(basis, axis.table(), std::nextafter(knot, -1e300));
    ExpectSameSpan(basis, axis.table(), random.Real(basis.lower(), basis.upper()));
  }
}

TEST(EvaluationTableTest, FindsTheSpansOfTheBasis) { ForRandomBases(ExpectSpansOf); }

TEST(EvaluationTableTest, FindsSpansHoweverUnevenTheyAre) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    RandomSplines random(seed);
    std::vector<double> breaks(1, random.Coin() ? 0.0 : random.Real(-1e6, 1e6));
    const double least = random.Logarithmic(1e-300, 1);
    for (int k = random.Integer(1, 100); k > 0; --k) {
      breaks.push_back(std::max(breaks.back() + random.Logarithmic(least, 1e3),
                                std::nextafter(breaks.back(), 1e300)));
    }
    ExpectSpansOf(SplineBasis::Clamped(random.Integer(1, 3), breaks), random);
  }
}

TEST(EvaluationTableTest, FindsSpansOfTheSmallestAndTheLargestDomain) {
  RandomSplines random(1);
  const double tiny = 3e-308;
  ExpectSpansOf(SplineBasis::Clamped(2, std::vector<double>{0, tiny, 2 * tiny}), random);
  ExpectSpansOf(SplineBasis::Clamped(2, std::vector<double>{-8e307, 1, 8e307}), random);
}

// E_0 ≥ 0, sums of the functions are one and of their derivatives zero, and the functions are those
// of the basis, each to its own size.
TEST(EvaluationTableTest, HoldsTheBasisFunctions) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines& random) {
    constexpr int kOrder = 3;
    const AxisStorage axis(basis, kOrder);
    const AxisTable& table = axis.table();
    const int p = basis.degree(), stride = table.row_stride;
    for (int i = 0; i < table.span_stride && i < (p + 1) * stride; ++i)
      EXPECT_GE(table.basis[i], 0);
    for (int k = 0; k < 10; ++k) {
      const double u = random.Parameter(basis);
      double values[4 * (kMaxDegree + 4)], wanted[4 * (kMaxDegree + 1)];
      lanes::BasisValues<lanes::kAny, kOrder>(table, lanes::Locate(table, u), values);
      const int span = basis.Span(u);
      basis.Derivatives(span, u, kOrder, wanted);
      const double length = basis.knots()[span + 1] - basis.knots()[span];
      double size = 1;  // p!/(p−k)! (2/h)^k bounds the terms
      for (int d = 0; d <= kOrder; size *= std::max(0, p - d) * 2 / length, ++d) {
        for (int r = 0; r <= p; ++r) {
          const double allowed = d == 0 ? wanted[r] : size;
          EXPECT_NEAR(values[d * stride + r], wanted[d * (p + 1) + r], 1e-14 * allowed)
              << d << ' ' << r << " at " << u;
        }
      }
    }
  });
}

}  // namespace batten::internal::evaluation_table_test
