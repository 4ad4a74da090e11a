// SPDX-License-Identifier: MIT
#include "batten/io/deviation_limit.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "batten/fitting/statistics.h"

namespace batten {
namespace {

// The next of 1, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10 times a power of ten.
double RoundedUp(double value) {
  constexpr double kSlack = 1 - 1e-12;
  const double power = std::floor(std::log10(value));
  const double unit = std::pow(10.0, power);
  for (const double digit : {1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0}) {
    const double rounded = power < 0 ? digit / std::pow(10.0, -power) : digit * unit;
    if (rounded >= value * kSlack) return rounded;
  }
  return power < -1 ? 1 / std::pow(10.0, -power - 1) : std::pow(10.0, power + 1);
}

}  // namespace

double DeviationLimit(const Eigen::VectorXd& distances,
                      const PointMask& outliers,
                      std::optional<double> tolerance,
                      double noise,
                      double size) {
  if (tolerance) return *tolerance;
  constexpr double kShare = 0.99, kSigmas = 3, kMost = 3, kSmallest = 1e-9;
  std::vector<double> sizes;
  for (Eigen::Index k = 0; k < distances.size(); ++k) {
    if (outliers.size() == 0 || !outliers[k]) sizes.push_back(std::abs(distances[k]));
  }
  double limit = sizes.empty() ? 0 : QuantileInPlace(sizes, kShare);
  if (!(limit > 0) && !sizes.empty()) limit = *std::max_element(sizes.begin(), sizes.end());
  limit = std::max(std::min(kSigmas * noise, kMost * limit), limit);
  limit = std::max(limit, kSmallest * size);
  return limit > 0 ? RoundedUp(limit) : 1;
}

}  // namespace batten
