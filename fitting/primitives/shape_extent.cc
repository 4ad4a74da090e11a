// SPDX-License-Identifier: MIT
#include "fitting/primitives/shape_extent.h"

#include <algorithm>
#include <cmath>

#include "batten/fitting/statistics.h"

namespace batten::internal {

std::vector<double> Supported(const std::vector<double>& places, double period) {
  constexpr int kFewest = 16, kNeighbours = 5;
  constexpr double kLonely = 6;  // median window widths: wider windows hold isolated places
  const int count = static_cast<int>(places.size());
  if (count < kFewest) return places;
  std::vector<double> sorted = places;
  std::sort(sorted.begin(), sorted.end());
  const bool round = std::isfinite(period);
  const int windows = round ? count : count - kNeighbours + 1;
  std::vector<double> width(static_cast<size_t>(windows));
  for (int i = 0; i < windows; ++i) {
    const int last = i + kNeighbours - 1;
    width[i] = (last < count ? sorted[last] : sorted[last - count] + period) - sorted[i];
  }
  const double usual = Median(width);
  if (!(usual > 0)) return places;
  std::vector<double> kept;
  for (const double place : places) {
    const int at =
        static_cast<int>(std::lower_bound(sorted.begin(), sorted.end(), place) - sorted.begin());
    for (int i = at - kNeighbours + 1; i <= at; ++i) {
      if (!round && (i < 0 || i >= windows)) continue;
      if (width[(i + count) % count] > kLonely * usual) continue;
      kept.push_back(place);
      break;
    }
  }
  return kept.empty() ? places : kept;
}

}  // namespace batten::internal
