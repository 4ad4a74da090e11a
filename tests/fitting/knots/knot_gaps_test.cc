// SPDX-License-Identifier: MIT
#include "fitting/knots/knot_gaps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::knot_gaps_test {

template <class Law>
void ForRandomGaps(const Law& law) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    law(random,
        KnotGaps(
            random.Basis(random.Integer(1, 10), {.clamped = random.Coin(), .most_spans = 12})));
    if (testing::Test::HasFailure()) return;
  }
}

TEST(KnotGapsTest, GroupsAreTheDifferentInteriorKnotsAndGapsFillTheDomain) {
  ForRandomGaps([](RandomSplines&, const KnotGaps& gaps) {
    const SplineBasis& basis = gaps.basis();
    std::vector<double> inside;
    for (const double t : basis.knots()) {
      if (t > basis.lower() && t < basis.upper()) inside.push_back(t);
    }
    std::vector<double> grouped;
    for (int g = 0; g < gaps.groups(); ++g)
      grouped.insert(grouped.end(), static_cast<size_t>(gaps.multiplicity(g)), gaps.knot(g));
    EXPECT_EQ(grouped, inside);
    const std::vector<double> h = gaps.Gaps();
    ASSERT_EQ(static_cast<int>(h.size()), gaps.groups() + 1);
    for (const double gap : h) EXPECT_GT(gap, 0);
    EXPECT_NEAR(std::accumulate(h.begin(), h.end(), 0.0), gaps.length(), kRounding * gaps.length());
    const std::vector<int> group_of = gaps.GroupOfKnots();
    for (size_t i = 0; i < group_of.size(); ++i) {
      if (group_of[i] >= 0) {
        EXPECT_EQ(basis.knots()[i], gaps.knot(group_of[i]));
      }
    }
    EXPECT_EQ(static_cast<size_t>(
                  std::count_if(group_of.begin(), group_of.end(), [](int g) { return g >= 0; })),
              inside.size());
  });
}

TEST(KnotGapsTest, VariablesHaveMeanZeroAndLeadBackToTheKnots) {
  ForRandomGaps([](RandomSplines& random, const KnotGaps& gaps) {
    const Eigen::VectorXd x = gaps.Variables();
    EXPECT_NEAR(x.sum(), 0, kRounding * static_cast<double>(x.size()));
    // A common shift changes nothing.
    const auto back = gaps.At(x.array() + random.Real(-5, 5));
    ASSERT_TRUE(back);
    for (size_t i = 0; i < gaps.basis().knots().size(); ++i)
      EXPECT_NEAR(back->basis().knots()[i], gaps.basis().knots()[i], kRounding * gaps.length());
    for (int g = 0; g < gaps.groups(); ++g) EXPECT_EQ(back->multiplicity(g), gaps.multiplicity(g));
  });
}

TEST(KnotGapsTest, AnyVariablesGiveValidKnotsOrNone) {
  ForRandomGaps([](RandomSplines& random, const KnotGaps& gaps) {
    Eigen::VectorXd x = gaps.Variables();
    for (double& value : x) value += random.Real(-60, 60);
    const auto moved = gaps.At(x);  // the constructor of the basis checks all rules
    if (moved) {
      EXPECT_EQ(moved->groups(), gaps.groups());
      EXPECT_EQ(moved->basis().lower(), gaps.basis().lower());
      EXPECT_EQ(moved->basis().upper(), gaps.basis().upper());
    }
    x[0] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(gaps.At(x));
    x[0] = std::numeric_limits<double>::infinity();
    EXPECT_FALSE(gaps.At(x));
    // All of the domain to one gap: the others are lost in rounding.
    x.setZero();
    x[0] = 1000;
    EXPECT_EQ(gaps.At(x).has_value(), gaps.groups() == 0);
  });
}

TEST(KnotGapsTest, DerivativesAreThoseOfDifferences) {
  ForRandomGaps([](RandomSplines&, const KnotGaps& gaps) {
    const Eigen::MatrixXd derivatives = gaps.Derivatives();
    const Eigen::VectorXd x = gaps.Variables();
    const double step = 1e-5;  // third derivatives are of the size of the first
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      Eigen::VectorXd forward = x, backward = x;
      forward[i] += step;
      backward[i] -= step;
      const auto after = gaps.At(forward), before = gaps.At(backward);
      ASSERT_TRUE(after && before);
      for (int g = 0; g < gaps.groups(); ++g) {
        EXPECT_NEAR(derivatives(g, i),
                    (after->knot(g) - before->knot(g)) / (2 * step),
                    kHalfDigits * gaps.length());
      }
    }
  });
}

TEST(KnotGapsTest, CoalescedKnotsAreExactlyEqualAndNeverMoreThanTheDegree) {
  const std::vector<double> breaks = {0, 0.1, 0.1 + 1e-9, 0.1 + 2e-9, 0.1 + 3e-9, 0.5, 0.7, 1};
  for (int p = 1; p <= 5; ++p) {
    SCOPED_TRACE("degree " + std::to_string(p));
    const KnotGaps gaps(SplineBasis::Clamped(p, breaks));
    const KnotGaps merged = gaps.Coalesced(1e-6);
    EXPECT_EQ(merged.basis().size(), gaps.basis().size());
    int most = 0;
    for (int g = 0; g < merged.groups(); ++g) most = std::max(most, merged.multiplicity(g));
    EXPECT_EQ(most, p >= 4 ? 4 : p == 3 ? 2 : p);
    EXPECT_LE(merged.groups(), gaps.groups() - (p >= 4 ? 3 : p >= 2 ? 2 : 0));
    EXPECT_EQ(merged.knot(merged.groups() - 1), 0.7);
    EXPECT_EQ(gaps.Coalesced(0).groups(), gaps.groups());
  }
}

TEST(KnotGapsTest, AMergedKnotIsTheMeanOfBothWeightedByMultiplicity) {
  ForRandomGaps([](RandomSplines&, const KnotGaps& gaps) {
    for (int g = 0; g + 1 < gaps.groups(); ++g) {
      const int a = gaps.multiplicity(g), b = gaps.multiplicity(g + 1);
      const auto merged = gaps.Merged(g);
      ASSERT_EQ(merged.has_value(), a + b <= gaps.basis().degree());
      if (!merged) continue;
      EXPECT_EQ(merged->groups(), gaps.groups() - 1);
      EXPECT_EQ(merged->multiplicity(g), a + b);
      EXPECT_NEAR(merged->knot(g),
                  (a * gaps.knot(g) + b * gaps.knot(g + 1)) / (a + b),
                  kRounding * gaps.length());
    }
  });
}

}  // namespace batten::internal::knot_gaps_test
