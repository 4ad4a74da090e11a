// SPDX-License-Identifier: MIT
// Order statistics that the fitting stages share.
#pragma once

#include <utility>
#include <vector>

namespace batten {

// From the median of absolute deviations to the standard deviation of a normal distribution.
inline constexpr double kMadToSigma = 1.482602218505602;

// The value at a fraction of the sorted sample, linear between neighbours; NaN of an empty sample.
// Takes a copy because it reorders. O(n).
double Quantile(std::vector<double> values, double fraction);
double QuantileInPlace(std::vector<double>& values, double fraction);  // reorders them
inline double Median(std::vector<double> values) { return Quantile(std::move(values), 0.5); }

// The least value that, with those below it, holds a share of all weight, of pairs of a value and
// its weight (positive); NaN of none. O(n log n).
double WeightedQuantile(std::vector<std::pair<double, double>> weighted, double share);
inline double WeightedMedian(std::vector<std::pair<double, double>> weighted) {
  return WeightedQuantile(std::move(weighted), 0.5);
}

}  // namespace batten
