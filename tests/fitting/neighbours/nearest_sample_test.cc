// SPDX-License-Identifier: MIT
#include "fitting/neighbours/nearest_sample.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "random_splines.h"

namespace batten::internal::nearest_sample_test {

TEST(NearestSampleTest, IsTheFirstOfTheNearest) {
  RandomSplines random(1);
  for (int round = 0; round < 300; ++round) {
    SCOPED_TRACE(round);
    const int own = random.Integer(1, 70);
    const std::ptrdiff_t filled = (own + kSampleLanes - 1) / kSampleLanes * kSampleLanes;
    std::vector<double> x(static_cast<size_t>(filled), HUGE_VAL), y = x;
    const bool whole = random.Coin();  // numbers, whose squares are exact and often the same
    const auto number = [&] { return whole ? random.Integer(-3, 3) : random.Real(-3, 3); };
    for (int i = 0; i < own; ++i) {
      x[i] = number();
      y[i] = number();
    }
    const double at_x = number(), at_y = number();
    const std::ptrdiff_t nearest = NearestSample(x.data(), y.data(), filled, at_x, at_y);
    const auto square = [&](std::ptrdiff_t i) {
      return (x[i] - at_x) * (x[i] - at_x) + (y[i] - at_y) * (y[i] - at_y);
    };
    ASSERT_LT(nearest, own);
    // Products may be fused with the sum: what is not whole agrees to rounding.
    const double slack = whole ? 0 : 1e-14;
    for (int i = 0; i < own; ++i) {
      EXPECT_LE(square(nearest), square(i) + slack);
      if (whole && i < nearest) {
        EXPECT_NE(square(i), square(nearest));
      }
    }
  }
}

}  // namespace batten::internal::nearest_sample_test
