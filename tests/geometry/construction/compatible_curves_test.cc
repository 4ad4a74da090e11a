// SPDX-License-Identifier: MIT
#include "batten/geometry/compatible_curves.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "construction_cases.h"
#include "tolerances.h"

namespace batten::internal::compatible_curves_test {

using Curves = std::vector<NurbsCurve<3>>;

TEST(CompatibleTest, LeavesEveryCurveAndGivesOneBasis) {
  for (int seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    Curves curves;
    for (int k = random.Integer(1, 6); k > 0; --k) {
      const bool periodic = random.Integer(0, 2) == 0;
      curves.push_back(random.Curve<3>(
          random.Integer(1, 5), random.Coin(), {.clamped = random.Coin(), .periodic = periodic}));
    }
    const Curves compatible = Compatible(curves);
    for (std::size_t k = 0; k < curves.size(); ++k) {
      EXPECT_EQ(compatible[k].basis(), compatible[0].basis());
      for (int j = 0; j <= 30; ++j) {
        EXPECT_LE((AtShare(curves[k], j / 30.0) - compatible[k].At(j / 30.0)).norm(), kIterated);
      }
    }
  }
}

TEST(CompatibleTest, NearlyEqualKnotsBecomeOne) {
  const auto with_knot = [](double knot) {
    return NurbsCurve<3>(SplineBasis(2, {0, 0, 0, knot, 1, 1, 1}), Eigen::Matrix3Xd::Random(3, 4));
  };
  EXPECT_EQ(
      Compatible({with_knot(0.1 + 0.2), with_knot(0.3), with_knot(0.3 + 4e-13)})[0].basis().size(),
      4);
  EXPECT_EQ(Compatible({with_knot(0.3), with_knot(0.3 + 1e-9)})[0].basis().size(), 5);
}

}  // namespace batten::internal::compatible_curves_test
