// SPDX-License-Identifier: MIT
#include "fitting/parameterization/projection_overlap.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace batten::internal {
namespace {

constexpr double kPlaceInSpacings = 4;
constexpr double kLayerShare = 0.3;
constexpr double kSteepestSlope = 2;  // steeper cells hold a continuum of heights, without a gap
constexpr std::uint32_t kCounted = 4;
constexpr double kMostPlacesAPoint = 4;  // above, cells are sorted instead of kept in an array

struct Shares {
  std::size_t places = 0, layered = 0;
};

// Whether there is a gap between layers; sorts the heights.
bool HasGap(double* first, std::size_t count, double gap) {
  std::sort(first, first + count);
  const auto layer =
      std::max<std::size_t>(2, static_cast<std::size_t>(kLayerShare * static_cast<double>(count)));
  for (std::size_t k = layer; k + layer <= count; ++k) {
    if (first[k] - first[k - 1] > gap) return true;
  }
  return false;
}

// Counts layered cells with an array over all cells; heights are examined only in cells whose range
// of heights exceeds a gap.
Shares CountInArray(const std::vector<std::uint32_t>& place_of,
                    const std::vector<double>& heights,
                    std::size_t places,
                    double gap) {
  struct Reach {
    float low = HUGE_VALF, high = -HUGE_VALF;
    std::uint32_t count = 0;
  };
  std::vector<Reach> reach(places);
  for (std::size_t k = 0; k < heights.size(); ++k) {
    Reach& own = reach[place_of[k]];
    const auto height = static_cast<float>(heights[k]);
    own.low = std::min(own.low, height);
    own.high = std::max(own.high, height);
    ++own.count;
  }
  constexpr float kRounded =
      0.999F;  // floats are nearer to the heights than that, or HasGap is asked
  Shares shares;
  std::vector<std::uint32_t> next(places, UINT32_MAX);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> asked;  // begin and count
  std::uint32_t end = 0;
  for (std::size_t place = 0; place < places; ++place) {
    const Reach& own = reach[place];
    if (own.count < kCounted) continue;
    ++shares.places;
    const float most = std::max(std::abs(own.low), std::abs(own.high));
    if (own.high - own.low + 1e-6F * most < kRounded * static_cast<float>(gap)) continue;
    next[place] = end;
    asked.emplace_back(end, own.count);
    end += own.count;
  }
  std::vector<double> sorted(end);
  for (std::size_t k = 0; end > 0 && k < heights.size(); ++k) {
    std::uint32_t& at = next[place_of[k]];
    if (at != UINT32_MAX) sorted[at++] = heights[k];
  }
  for (const auto& [begin, count] : asked)
    shares.layered += HasGap(sorted.data() + begin, count, gap) ? 1 : 0;
  return shares;
}

// Counts layered cells by sorting, for cells scattered over a large area.
Shares CountSorted(const std::vector<std::pair<std::int64_t, std::int64_t>>& place_of,
                   const std::vector<double>& heights,
                   double gap) {
  std::vector<std::uint32_t> order(heights.size());
  for (std::uint32_t k = 0; k < order.size(); ++k) order[k] = k;
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return place_of[a] < place_of[b];
  });
  Shares shares;
  std::vector<double> own;
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    own.clear();
    for (; end < order.size() && place_of[order[end]] == place_of[order[begin]]; ++end)
      own.push_back(heights[order[end]]);
    if (own.size() < kCounted) continue;
    ++shares.places;
    shares.layered += HasGap(own.data(), own.size(), gap) ? 1 : 0;
  }
  return shares;
}

}  // namespace

double LayeredPlaces(const Eigen::Matrix3Xd& points,
                     const Eigen::Vector3d& origin,
                     const Eigen::Matrix3d& axes,
                     double spacing,
                     double steepest_tangent) {
  const double cell = kPlaceInSpacings * spacing;
  if (!(cell > 0)) return 0;
  const double gap = 1.5 * cell * std::clamp(steepest_tangent, 1.0, kSteepestSlope);
  const auto count = static_cast<std::size_t>(points.cols());
  const auto place = [&](Eigen::Index k, int d) {
    return std::floor(axes.col(d).dot(points.col(k) - origin) / cell);
  };
  std::vector<double> heights(count);
  double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
  for (std::size_t k = 0; k < count; ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    heights[k] = axes.col(2).dot(points.col(column) - origin);
    for (int d = 0; d < 2; ++d) {
      low[d] = std::min(low[d], place(column, d));
      high[d] = std::max(high[d], place(column, d));
    }
  }
  const double nu = high[0] - low[0] + 1, nv = high[1] - low[1] + 1;
  Shares shares;
  if (nu * nv <= std::min(kMostPlacesAPoint * static_cast<double>(count) + 1024, 1e9)) {
    std::vector<std::uint32_t> place_of(count);
    for (std::size_t k = 0; k < count; ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      place_of[k] = static_cast<std::uint32_t>((place(column, 0) - low[0]) * nv +
                                               (place(column, 1) - low[1]));
    }
    shares = CountInArray(place_of, heights, static_cast<std::size_t>(nu * nv), gap);
  } else {
    std::vector<std::pair<std::int64_t, std::int64_t>> place_of(count);
    for (std::size_t k = 0; k < count; ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      place_of[k] = {std::llround(place(column, 0)), std::llround(place(column, 1))};
    }
    shares = CountSorted(place_of, heights, gap);
  }
  return shares.places > 0
             ? static_cast<double>(shares.layered) / static_cast<double>(shares.places)
             : 0;
}

}  // namespace batten::internal
