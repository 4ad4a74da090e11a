// SPDX-License-Identifier: MIT
#include "io/report/report_points.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>

#include "batten/fitting/statistics.h"
#include "geometry/numeric/mixed_bits.h"

namespace batten::internal {
namespace {

using Indices = std::vector<Eigen::Index>;

// Leaves the `count` of the greatest sizes; of equal ones those of the lowest numbers.
void KeepFarthest(Indices& points, const Eigen::VectorXd& deviations, Eigen::Index count) {
  if (static_cast<Eigen::Index>(points.size()) <= count) return;
  std::nth_element(
      points.begin(), points.begin() + count, points.end(), [&](Eigen::Index a, Eigen::Index b) {
        const double off_a = std::abs(deviations[a]), off_b = std::abs(deviations[b]);
        return off_a > off_b || (off_a == off_b && a < b);
      });
  points.resize(static_cast<std::size_t>(count));
}

std::vector<double> Counting(const Eigen::VectorXd& deviations, const PointMask& outliers) {
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(deviations.size()));
  for (Eigen::Index k = 0; k < deviations.size(); ++k) {
    if (outliers.size() == 0 || !outliers[k]) values.push_back(deviations[k]);
  }
  return values;
}

}  // namespace

Indices EvenlySpread(Eigen::Index total, Eigen::Index count) {
  Indices chosen;
  if (count <= 0) return chosen;
  chosen.reserve(static_cast<std::size_t>(std::min(total, count)));
  if (total <= count) {
    for (Eigen::Index k = 0; k < total; ++k) chosen.push_back(k);
    return chosen;
  }
  for (Eigen::Index run = 0; run < count; ++run) {
    const Eigen::Index begin = run * total / count, end = (run + 1) * total / count;
    const auto length = static_cast<std::uint64_t>(end - begin);
    chosen.push_back(begin + static_cast<Eigen::Index>(Mixed(std::uint64_t(run)) % length));
  }
  return chosen;
}

Indices ShownPoints(const Eigen::VectorXd& deviations,
                    const PointMask& outliers,
                    Eigen::Index most) {
  const Eigen::Index total = deviations.size();
  if (total <= most) return EvenlySpread(total, total);
  Indices set_aside, counting;
  counting.reserve(static_cast<std::size_t>(total));
  for (Eigen::Index k = 0; k < total; ++k) {
    (outliers.size() > 0 && outliers[k] ? set_aside : counting).push_back(k);
  }
  constexpr Eigen::Index kWorst = 100;  // one in so many
  KeepFarthest(set_aside, deviations, most / 2);
  Indices worst = counting;
  KeepFarthest(worst, deviations, most / kWorst);
  Indices shown = std::move(set_aside);
  shown.insert(shown.end(), worst.begin(), worst.end());
  std::sort(worst.begin(), worst.end());
  Indices others;
  others.reserve(counting.size() - worst.size());
  std::set_difference(
      counting.begin(), counting.end(), worst.begin(), worst.end(), std::back_inserter(others));
  const Indices spread =
      EvenlySpread(static_cast<Eigen::Index>(others.size()), most - std::ssize(shown));
  for (const Eigen::Index k : spread) shown.push_back(others[static_cast<std::size_t>(k)]);
  std::sort(shown.begin(), shown.end());
  return shown;
}

ReportHistogram HistogramOf(const Eigen::VectorXd& deviations,
                            const PointMask& outliers,
                            std::optional<double> tolerance,
                            bool signed_values) {
  ReportHistogram histogram;
  std::vector<double> values = Counting(deviations, outliers);
  if (values.empty()) return histogram;
  constexpr double kTail = 0.002, kMargin = 0.05, kFar = 3, kHalf = 0.5, kWide = 6;
  constexpr int kBins = 60;
  double low = QuantileInPlace(values, kTail), high = QuantileInPlace(values, 1 - kTail);
  // A few far ones must not press all others into one bin.
  const double middle = Median(values);
  std::vector<double> offsets(values);
  for (double& offset : offsets) offset = std::abs(offset - middle);
  const double sigma = kMadToSigma * QuantileInPlace(offsets, kHalf);
  if (sigma > 0) {
    low = std::max(low, middle - kWide * sigma);
    high = std::min(high, middle + kWide * sigma);
  }
  const double spread = high - low;
  // Zero and the tolerance, where that leaves the values a good part of the width.
  const auto include = [&](double value) {
    const double wider = std::max(high, value) - std::min(low, value);
    if (wider > kFar * spread) return;
    low = std::min(low, value);
    high = std::max(high, value);
  };
  include(0);
  if (tolerance) include(*tolerance);
  if (tolerance && signed_values) include(-*tolerance);
  double margin = kMargin * (high - low);
  // All the same, to rounding: a bin's width that shows where.
  const double rounding = 1e-12 * std::max(std::abs(low), std::abs(high));
  if (!(margin > rounding)) margin = std::max({rounding, kMargin * std::abs(high), 1e-300});
  low = signed_values ? low - margin : std::max(0.0, low - margin);
  high += margin;
  if (!signed_values && low < kFar * margin) low = 0;
  const auto all = Eigen::Map<const Eigen::ArrayXd>(values.data(), std::ssize(values));
  histogram.mean = all.mean();
  histogram.deviation = std::sqrt((all - histogram.mean).square().mean());
  histogram.low = low;
  histogram.high = high;
  histogram.counts.assign(kBins, 0);
  for (const double value : values) {
    if (value < low) {
      ++histogram.below;
    } else if (value > high) {
      ++histogram.above;
    } else {
      const auto bin = static_cast<std::size_t>((value - low) / (high - low) * kBins);
      ++histogram.counts[std::min<std::size_t>(bin, kBins - 1)];
    }
  }
  return histogram;
}

}  // namespace batten::internal
