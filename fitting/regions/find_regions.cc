// SPDX-License-Identifier: MIT
#include "fitting/regions/find_regions.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "batten/fitting/statistics.h"
#include "fitting/regions/free_pieces.h"
#include "fitting/regions/region_shape.h"
#include "fitting/regions/settle_regions.h"

namespace batten::internal {
namespace {

// The rms distance of points from their regions' shapes, as most regions' points have it.
double SigmaOf(const RegionPoints& data, const RegionLabels& labels, double assumed) {
  std::vector<std::pair<double, double>> weighted;
  for (const Region& region : labels.regions) {
    weighted.emplace_back(TestShape(data, region.points, region.shape, assumed).rms,
                          static_cast<double>(region.points.size()));
  }
  return weighted.empty() ? assumed : std::max(data.rounding, WeightedMedian(std::move(weighted)));
}

RegionLabels RegionsAt(const RegionPoints& data,
                       double sigma,
                       const Progress& progress,
                       ThreadPool& pool) {
  RegionLabels labels = GrowRegions(data, sigma, kFewestPoints, progress, pool);
  SettleRegions(data, sigma, kFewestPoints, labels, pool);
  return labels;
}

Eigen::Index Explained(const RegionLabels& labels) {
  return std::count_if(
      labels.label.begin(), labels.label.end(), [](int label) { return label != kNoRegion; });
}

FoundRegions AtTheirNoise(const RegionPoints& data,
                          double tolerance,
                          const Progress& progress,
                          ThreadPool& pool) {
  constexpr double kNearer = 0.7;  // of the noise assumed: regions at it have looser borders
  constexpr double kAsManyPoints = 0.9;
  const double assumed = std::max(data.noise, tolerance / kFarFromShape);
  FoundRegions found{RegionsAt(data, assumed, progress, pool), assumed};
  found.sigma = SigmaOf(data, found.labels, assumed);
  if (tolerance > 0 || !(found.sigma < kNearer * assumed)) return found;
  FoundRegions sharper{RegionsAt(data, found.sigma, progress, pool), found.sigma};
  sharper.sigma = SigmaOf(data, sharper.labels, found.sigma);
  const auto before = static_cast<double>(Explained(found.labels));
  const bool as_many = static_cast<double>(Explained(sharper.labels)) >= kAsManyPoints * before;
  return as_many ? sharper : found;
}

}  // namespace

FoundRegions FindRegions(const RegionPoints& data,
                         double tolerance,
                         const Progress& progress,
                         ThreadPool& pool) {
  FoundRegions found = AtTheirNoise(data, tolerance, progress, pool);
  DissolvePieces(data, found.sigma, found.labels, pool);
  return found;
}

}  // namespace batten::internal
