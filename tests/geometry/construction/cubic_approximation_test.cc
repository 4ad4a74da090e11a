// SPDX-License-Identifier: MIT
#include "geometry/construction/cubic_approximation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace batten::internal::cubic_approximation_test {

TEST(CubicApproximationTest, KeepsTheToleranceBetweenItsPlacesAndKinks) {
  const VectorFunction function = [](double at, Side side) {
    // A kink at 1, a jump of curvature at 2.
    const double kink = at < 1 || (at == 1 && side == Side::kBelow) ? 0 : at - 1;
    const double bend = at < 2 ? 0 : (at - 2) * (at - 2);
    ValueAndSlope result{Eigen::VectorXd(1), Eigen::VectorXd(1)};
    result.value << std::sin(5 * at) + kink + bend;
    result.slope << 5 * std::cos(5 * at) + (kink > 0 || (at == 1 && side == Side::kAbove) ? 1 : 0) +
                        (at < 2 ? 0 : 2 * (at - 2));
    return result;
  };
  for (const double tolerance : {1e-3, 1e-6, 1e-9}) {
    const CubicApproximation cubic = ApproximateByCubic(
        function,
        {{0}, {1, 0}, {2, 1}, {3}},
        [](const Eigen::VectorXd& d) { return d.norm(); },
        tolerance,
        "test");
    double worst = 0;
    for (int k = 0; k <= 30000; ++k) {
      const double at = k / 10000.0;
      const int span = cubic.basis.Span(at);
      double values[4];
      cubic.basis.Values(span, at, values);
      double found = 0;
      for (int r = 0; r < 4; ++r) found += values[r] * cubic.coefficients(0, span - 3 + r);
      worst = std::max(worst, std::abs(found - function(at, Side::kAbove).value[0]));
    }
    EXPECT_LE(worst, tolerance);
    EXPECT_LE(cubic.basis.size(), 40 * std::pow(tolerance, -0.25));
  }
}

}  // namespace batten::internal::cubic_approximation_test
