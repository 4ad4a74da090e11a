// SPDX-License-Identifier: MIT
#include "fitting/primitives/angle_extent.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "geometry/numeric/constants.h"

namespace batten::internal {
namespace {

// The first and last of the angles in a sector; sectors without any have first > last.
struct Sector {
  double first = std::numeric_limits<double>::infinity();
  double last = -std::numeric_limits<double>::infinity();
};

// Whether so many angles lie all round the circle: no gap between neighbours is above 60°, or the
// widest is no more than 1.5 times the mean of the others: few points evenly spread.
bool AllRound(double widest_gap, std::ptrdiff_t count) {
  constexpr double kMostGap = kTurn / 6, kEven = 1.5;
  const double others = count > 1 ? (kTurn - widest_gap) / static_cast<double>(count - 1) : 0;
  return widest_gap <= kMostGap || widest_gap <= kEven * others;
}

}  // namespace

AngleGap WidestGapOf(const std::vector<double>& angles) {
  constexpr int kSectors = 4096;
  std::vector<Sector> sectors(kSectors);
  for (const double angle : angles) {
    const auto at = static_cast<int>((angle / kTurn + 0.5) * kSectors);
    Sector& sector = sectors[static_cast<size_t>(std::clamp(at, 0, kSectors - 1))];
    sector.first = std::min(sector.first, angle);
    sector.last = std::max(sector.last, angle);
  }
  std::erase_if(sectors, [](const Sector& s) { return s.first > s.last; });
  if (sectors.empty()) return {};
  AngleGap widest{sectors.front().first + kTurn - sectors.back().last,
                  sectors.front().first,
                  sectors.back().last - sectors.front().first};
  for (size_t k = 1; k < sectors.size(); ++k) {
    const double gap = sectors[k].first - sectors[k - 1].last;
    if (gap > widest.width) widest = {gap, sectors[k].first, kTurn - gap};
  }
  return widest;
}

// Gaps within a sector decide nothing: where one is the widest, the angles lie all round.
AngleRange ArcCovered(const std::vector<double>& angles) {
  const AngleGap widest = WidestGapOf(angles);
  if (AllRound(widest.width, std::ssize(angles))) return {angles.front(), kTurn};
  return {widest.end, widest.rest};
}

AngleRange AnglesCovered(const std::vector<double>& angles) {
  AngleRange range = ArcCovered(angles);
  range.start = range.full() ? 0 : range.start - kTurn * std::floor(range.start / kTurn);
  return range;
}

}  // namespace batten::internal
