// SPDX-License-Identifier: MIT
#include "geometry/numeric/gauss_rule.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tolerances.h"

namespace batten::internal::gauss_rule_test {

// The rule over [−1, 1].
GaussRule SymmetricRule(int count) {
  const GaussRule rule = GaussLegendre(count);
  return {(2 * rule.nodes).array() - 1, 2 * rule.weights};
}

TEST(GaussLegendreTest, IsExactUpToTwiceItsCountLessOne) {
  for (int count = 1; count <= 26; ++count) {
    const GaussRule quadrature = SymmetricRule(count);
    for (int degree = 0; degree <= 2 * count - 1; ++degree) {
      const double sum = (quadrature.weights.array() * quadrature.nodes.array().pow(degree)).sum();
      const double expected = degree % 2 == 1 ? 0 : 2.0 / (degree + 1);
      EXPECT_NEAR(sum, expected, kRounding) << count << " nodes, degree " << degree;
    }
  }
}

TEST(GaussLegendreTest, IsNotExactBeyond) {
  for (int count = 1; count <= 6; ++count) {
    const GaussRule quadrature = SymmetricRule(count);
    const double sum = (quadrature.weights.array() * quadrature.nodes.array().pow(2 * count)).sum();
    EXPECT_GT(std::abs(sum - 2.0 / (2 * count + 1)), kHalfDigits) << count << " nodes";
  }
}

TEST(GaussLegendreTest, HasPositiveWeightsAndNodesInside) {
  for (int count = 1; count <= 26; ++count) {
    const GaussRule quadrature = SymmetricRule(count);
    EXPECT_GT(quadrature.weights.minCoeff(), 0);
    EXPECT_LT(quadrature.nodes.cwiseAbs().maxCoeff(), 1);
  }
}

}  // namespace batten::internal::gauss_rule_test
