// SPDX-License-Identifier: MIT
#include "geometry/numeric/gauss_rule.h"

#include <cmath>
#include <numbers>

namespace batten::internal {

// Newton's iteration on the Legendre polynomial from the cosines that lie near its zeros; value and
// slope by the three-term recurrence.
GaussRule GaussLegendre(int count) {
  GaussRule rule{Eigen::VectorXd(count), Eigen::VectorXd(count)};
  constexpr int kSteps = 8;  // four are enough from there for any count
  for (int k = 0; k < count; ++k) {
    long double x = -std::cos(std::numbers::pi_v<long double> * (k + 0.75L) / (count + 0.5L));
    long double slope = 1;
    for (int step = 0; step < kSteps; ++step) {
      long double before = 0, value = 1;
      for (int n = 1; n <= count; ++n) {
        const long double next = ((2 * n - 1) * x * value - (n - 1) * before) / n;
        before = value;
        value = next;
      }
      slope = count * (x * value - before) / (x * x - 1);
      if (step + 1 < kSteps) x -= value / slope;
    }
    rule.nodes[k] = static_cast<double>((1 + x) / 2);
    rule.weights[k] = static_cast<double>(1 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

}  // namespace batten::internal
