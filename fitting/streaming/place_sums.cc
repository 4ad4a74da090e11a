// SPDX-License-Identifier: MIT
#include "fitting/streaming/place_sums.h"

#include <algorithm>
#include <cmath>

namespace batten::internal {
namespace {

// Of a place: u and v are from its middle.
enum PlaceNumber { kCount, kU, kV, kOffset, kSquare, kFarCount, kFarOffset, kFarSquare, kNumbers };

// Points that are as far off as others of their place are shape: as many, and within a quarter, as
// ResidualInliers asks of neighbours.
constexpr double kAlikeToCount = 5, kNearlyEqual = 0.25;

bool IsShape(const double* sums) {
  const double far = sums[kFarCount];
  if (far < kAlikeToCount || far < sums[kCount]) return false;
  const double mean = sums[kFarOffset] / far;
  const double variance = std::max(0.0, sums[kFarSquare] / far - mean * mean);
  return std::sqrt(variance) <= kNearlyEqual * std::abs(mean);
}

}  // namespace

PlaceGrid PlaceGrid::Of(const Eigen::Vector2d& low, const Eigen::Vector2d& high, double places) {
  const double ratio = (high[0] - low[0]) / (high[1] - low[1]);
  const double along_u = std::sqrt(places * ratio);
  const double most = std::max(1.0, places);
  const double count_u = std::clamp(std::round(along_u), 1.0, most);
  return {low,
          high,
          static_cast<int>(count_u),
          static_cast<int>(std::max(1.0, std::round(places / count_u)))};
}

Eigen::Index PlaceGrid::PlaceOf(const Eigen::Vector2d& at) const {
  const auto along = [&](int d, int count) {
    const double share = (at[d] - low[d]) / (high[d] - low[d]) * count;
    return static_cast<Eigen::Index>(std::clamp(share, 0.0, count - 1.0));
  };
  return along(0, count_u) * count_v + along(1, count_v);
}

Eigen::Vector2d PlaceGrid::Middle(Eigen::Index place) const {
  const auto i = static_cast<double>(place / count_v), j = static_cast<double>(place % count_v);
  return low + Eigen::Vector2d(i + 0.5, j + 0.5).cwiseProduct(step());
}

PlaceSums::PlaceSums(const PlaceGrid& grid)
    : grid_(grid), numbers_(static_cast<std::size_t>(grid.size() * kNumbers), 0.0) {}

void PlaceSums::Add(const Eigen::Vector2d& at, double offset, bool beyond) {
  const Eigen::Index place = grid_.PlaceOf(at);
  double* sums = numbers_.data() + place * kNumbers;
  if (beyond) {
    sums[kFarCount] += 1;
    sums[kFarOffset] += offset;
    sums[kFarSquare] += offset * offset;
    return;
  }
  const Eigen::Vector2d from = at - grid_.Middle(place);
  sums[kCount] += 1;
  sums[kU] += from[0];
  sums[kV] += from[1];
  sums[kOffset] += offset;
  sums[kSquare] += offset * offset;
}

PlaceSums::Means PlaceSums::Collected() const {
  Means means;
  double squares = 0, freedom = 0;
  for (Eigen::Index place = 0; place < grid_.size(); ++place) {
    const double* sums = numbers_.data() + place * kNumbers;
    const double near = sums[kCount], far = sums[kFarCount];
    const bool shape = IsShape(sums);
    if (!shape) means.set_aside += far;
    const double count = near + (shape ? far : 0);
    if (count == 0) continue;
    means.used += count;
    const Eigen::Vector2d from = near > 0
                                     ? Eigen::Vector2d(Eigen::Vector2d(sums[kU], sums[kV]) / near)
                                     : Eigen::Vector2d(Eigen::Vector2d::Zero());
    const double offset = sums[kOffset] + (shape ? sums[kFarOffset] : 0);
    means.places.push_back({grid_.Middle(place) + from, offset / count, count});
    if (near < 2) continue;
    squares += std::max(0.0, sums[kSquare] - sums[kOffset] * sums[kOffset] / near);
    freedom += near - 1;
  }
  if (freedom > 0) means.variance = squares / freedom;
  return means;
}

}  // namespace batten::internal
