// SPDX-License-Identifier: MIT
#include "batten/fitting/statistics.h"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace batten {

double Quantile(std::vector<double> values, double fraction) {
  return QuantileInPlace(values, fraction);
}

double QuantileInPlace(std::vector<double>& values, double fraction) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const double position = std::clamp(fraction, 0.0, 1.0) * static_cast<double>(values.size() - 1);
  const auto low = static_cast<std::ptrdiff_t>(position);
  std::nth_element(values.begin(), values.begin() + low, values.end());
  const double a = values[low];
  if (low + 1 == static_cast<std::ptrdiff_t>(values.size())) return a;
  const double b = *std::min_element(values.begin() + low + 1, values.end());
  return a + (b - a) * (position - static_cast<double>(low));
}

double WeightedQuantile(std::vector<std::pair<double, double>> weighted, double share) {
  std::sort(weighted.begin(), weighted.end());
  double all = 0, below = 0;
  for (const auto& [value, weight] : weighted) all += weight;
  for (const auto& [value, weight] : weighted) {
    below += weight;
    if (below >= share * all) return value;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace batten
