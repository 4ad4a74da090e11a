// SPDX-License-Identifier: MIT
#include "fitting/core/distributions.h"

#include <cmath>
#include <initializer_list>
#include <limits>
#include <numbers>

#include "fitting/core/rounding.h"
#include "fitting/core/shared_constants.h"

namespace batten::internal {
namespace {

// Converges fast for x < (a + 1) / (a + b + 2).
double BetaFraction(double x, double a, double b) {
  constexpr int kMost = 10000;
  constexpr double kTiny = 1e-300, kSteady = 1e-15;
  const auto away = [](double value) { return std::abs(value) < kTiny ? kTiny : value; };
  double c = 1, d = 1 / away(1 - (a + b) * x / (a + 1)), fraction = d;
  for (int m = 1; m <= kMost; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    for (const double term : {even, odd}) {
      d = 1 / away(1 + term * d);
      c = away(1 + term / c);
      fraction *= c * d;
    }
    if (std::abs(c * d - 1) < kSteady) break;
  }
  return fraction;
}

}  // namespace

double IncompleteBeta(double x, double a, double b) {
  if (!(x > 0)) return 0;
  if (!(x < 1)) return 1;
  const double front = std::exp(a * std::log(x) + b * std::log1p(-x) + std::lgamma(a + b) -
                                std::lgamma(a) - std::lgamma(b));
  if (x < (a + 1) / (a + b + 2)) return front * BetaFraction(x, a, b) / a;
  return 1 - front * BetaFraction(1 - x, b, a) / b;
}

double FTail(double f, double freedoms_above, double freedoms_below) {
  if (!(f > 0)) return 1;
  if (!std::isfinite(f)) return 0;
  const double x = freedoms_below / (freedoms_below + freedoms_above * f);
  return IncompleteBeta(x, freedoms_below / 2, freedoms_above / 2);
}

double FewFactor(double freedoms_left) {
  if (!(freedoms_left >= 1)) return std::numeric_limits<double>::infinity();
  const double outside = std::erfc(kThreeSigmas / std::numbers::sqrt2);
  double low = 1, high = 100;
  while (high - low > kRelativelyEqual * high) {
    const double middle = (low + high) / 2;
    (FTail(kThreeSigmas * kThreeSigmas * middle * middle, 1, freedoms_left) > outside ? low
                                                                                      : high) =
        middle;
  }
  return high;
}

}  // namespace batten::internal
