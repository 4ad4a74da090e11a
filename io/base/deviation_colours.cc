// SPDX-License-Identifier: MIT
#include "batten/io/deviation_colours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "batten/fitting/statistics.h"

namespace batten {
namespace {

// Moreland's "smooth cool warm" at nine even steps.
constexpr std::array<std::array<double, 3>, 9> kSteps{{{59, 76, 192},
                                                       {98, 130, 234},
                                                       {141, 176, 254},
                                                       {184, 208, 249},
                                                       {221, 221, 221},
                                                       {245, 196, 173},
                                                       {244, 154, 123},
                                                       {222, 96, 77},
                                                       {180, 4, 38}}};
const Rgb kBelow(24, 31, 86), kAbove(84, 0, 16), kUnknown(128, 128, 128);

}  // namespace

Rgb DeviationColour(double deviation, double range) {
  if (!(range > 0)) throw std::invalid_argument("DeviationColour: range: must be positive");
  if (std::isnan(deviation)) return kUnknown;
  if (deviation < -range) return kBelow;
  if (deviation > range) return kAbove;
  const double step =
      std::clamp((deviation / range + 1) / 2, 0.0, 1.0) * static_cast<double>(kSteps.size() - 1);
  const auto first = std::min(static_cast<std::size_t>(step), kSteps.size() - 2);
  const double share = step - static_cast<double>(first);
  Rgb colour;
  for (std::size_t k = 0; k < 3; ++k) {
    colour[static_cast<Eigen::Index>(k)] = static_cast<std::uint8_t>(
        std::lround(kSteps[first][k] + share * (kSteps[first + 1][k] - kSteps[first][k])));
  }
  return colour;
}

RgbColumns DeviationColours(const Eigen::VectorXd& deviations, double range) {
  RgbColumns colours(3, deviations.size());
  for (Eigen::Index k = 0; k < deviations.size(); ++k) {
    colours.col(k) = DeviationColour(deviations[k], range);
  }
  return colours;
}

double DeviationRange(const Eigen::VectorXd& deviations) {
  constexpr double kShare = 0.95;
  std::vector<double> sizes;
  for (const double deviation : deviations) {
    if (std::isfinite(deviation)) sizes.push_back(std::abs(deviation));
  }
  const double most = sizes.empty() ? 0 : QuantileInPlace(sizes, kShare);
  if (!(most > 0)) return 1;
  // Divided by a whole power where it is small: 5 / 100 is the number 0.05, 5 × 0.01 is not.
  for (int exponent = static_cast<int>(std::floor(std::log10(most))) - 1;; ++exponent) {
    for (const double digit : {1.0, 2.0, 5.0}) {
      const double range =
          exponent < 0 ? digit / std::pow(10.0, -exponent) : digit * std::pow(10.0, exponent);
      if (range >= most * (1 - 1e-12)) return range;
    }
  }
}

}  // namespace batten
