// SPDX-License-Identifier: MIT
// Integrals by a rule with published nodes on many equal parts, to compare others with.
#pragma once

#include <array>
#include <utility>

namespace batten::internal {

// 10-point Gauss–Legendre nodes and weights on [-1, 1], positive half. [Abramowitz & Stegun 1964,
// table 25.4]
inline constexpr std::array<std::pair<double, double>, 5> kTenPointGauss{
    {{0.148874338981631211, 0.295524224714752870},
     {0.433395394129247191, 0.269266719309996355},
     {0.679409568299024406, 0.219086362515982044},
     {0.865063366688984511, 0.149451349150580593},
     {0.973906528517171720, 0.066671344308688138}}};

template <typename Function>
double CompositeGauss(Function f, double low, double high, int parts) {
  double sum = 0;
  for (int k = 0; k < parts; ++k) {
    const double half = (high - low) / parts / 2, middle = low + (2 * k + 1) * half;
    for (const auto& [node, weight] : kTenPointGauss) {
      sum += weight * half * (f(middle - half * node) + f(middle + half * node));
    }
  }
  return sum;
}

}  // namespace batten::internal
