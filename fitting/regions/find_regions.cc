// SPDX-License-Identifier: MIT
#include "fitting/regions/find_regions.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/robust_loss.h"
#include "batten/fitting/statistics.h"
#include "fitting/primitives/surface_minimum.h"
#include "fitting/regions/free_pieces.h"
#include "fitting/regions/grow_coarsely.h"
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

// Takes narrow regions away, and returns them.
std::vector<Region> TakeNarrow(const RegionPoints& data, RegionLabels& labels) {
  RegionLabels kept{{}, std::vector<int>(labels.label.size(), kNoRegion)};
  std::vector<Region> narrow;
  for (Region& region : labels.regions) {
    if (IsNarrow(data, labels.label, region.points)) {
      narrow.push_back(std::move(region));
    } else {
      Append(std::move(region), kept);
    }
  }
  labels = std::move(kept);
  return narrow;
}

// Free points with points of a region within two rings: all those of a narrow face.
std::vector<int> LeftBeside(const RegionPoints& data, const std::vector<int>& label) {
  std::vector<int> left;
  const auto taken = [&](int point) { return label[std::size_t(point)] != kNoRegion; };
  for (int k = 0; k < static_cast<int>(data.size()); ++k) {
    if (taken(k)) continue;
    const auto around = data.Around(k);
    const bool beside = std::any_of(around.begin(), around.end(), [&](int one) {
      const auto next = data.Around(one);
      return taken(one) || std::any_of(next.begin(), next.end(), taken);
    });
    if (beside) left.push_back(k);
  }
  return left;
}

// Regions of the points, in the numbers of all, that are bounded by regions: few of their points
// have free ones beside them. What free points bound is the rim of something else.
std::vector<Region> NarrowOf(const RegionPoints& data,
                             const std::vector<int>& taken,
                             std::vector<Region> grown) {
  constexpr std::ptrdiff_t kFew = 4;  // one in so many
  for (bool changed = true; changed;) {
    std::vector<int> label = taken;
    for (const Region& region : grown) {
      for (const int point : region.points) label[std::size_t(point)] = 0;
    }
    const auto beside_free = [&](int point) {
      const auto around = data.Around(point);
      return std::any_of(around.begin(), around.end(), [&](int other) {
        return label[std::size_t(other)] == kNoRegion;
      });
    };
    changed = std::erase_if(grown, [&](const Region& region) {
                const auto open =
                    std::count_if(region.points.begin(), region.points.end(), beside_free);
                return kFew * open >= std::ssize(region.points);
              }) > 0;
  }
  return grown;
}

// Grows narrow regions anew once the larger ones have their borders: beside these, narrow faces
// have no neighbourhoods and normals of their own. They get normals. Whether there are new ones.
bool GrowNarrow(RegionPoints& data,
                double sigma,
                RegionLabels& labels,
                const Progress& progress,
                ThreadPool& pool) {
  if (!data.normals_estimated) return false;
  bool found = false;
  std::vector<Region> before = TakeNarrow(data, labels);
  const std::vector<int> left = LeftBeside(data, labels.label);
  std::vector<int> taken = labels.label;  // those of narrow regions too
  for (const Region& region : before) {
    for (const int point : region.points) taken[std::size_t(point)] = 0;
  }
  if (std::ssize(left) >= kFewestPoints) {
    const RegionPoints part = PartOf(data, left, data.spacing, pool);
    std::vector<Region> grown = GrowRegions(part, sigma, progress, pool).regions;
    for (Region& region : grown) {
      for (int& point : region.points) point = left[std::size_t(point)];
    }
    const auto take = [&](std::vector<Region> narrow) {
      for (Region& region : narrow) Append(std::move(region), labels);
      found = found || !narrow.empty();
    };
    take(NarrowOf(data, labels.label, grown));
    // What nothing explained before may lie among the narrow ones.
    std::erase_if(grown, [&](const Region& region) {
      const auto old = std::count_if(region.points.begin(), region.points.end(), [&](int point) {
        return taken[std::size_t(point)] != kNoRegion;
      });
      return labels.label[std::size_t(region.points[0])] != kNoRegion ||
             2 * old >= std::ssize(region.points);
    });
    take(NarrowOf(data, taken, std::move(grown)));
    for (std::size_t k = 0; k < left.size(); ++k) {
      if (labels.label[std::size_t(left[k])] == kNoRegion) continue;
      data.normals.col(left[k]) = part.normals.col(Eigen::Index(k));
      data.turn[left[k]] = part.turn[Eigen::Index(k)];
    }
  }
  // What is not found again was none of these.
  for (Region& region : before) {
    std::erase_if(region.points,
                  [&](int point) { return labels.label[std::size_t(point)] != kNoRegion; });
    if (std::ssize(region.points) >= kFewestPoints) Append(std::move(region), labels);
  }
  return found;
}

RegionLabels RegionsAt(RegionPoints& data,
                       double sigma,
                       const Progress& progress,
                       ThreadPool& pool) {
  RegionLabels labels = GrowCoarsely(data, sigma, progress, pool);
  SettleRegions(data, sigma, labels, pool);
  if (GrowNarrow(data, sigma, labels, progress, pool)) SettleRegions(data, sigma, labels, pool);
  return labels;
}

Eigen::Index Explained(const RegionLabels& labels) {
  return std::count_if(
      labels.label.begin(), labels.label.end(), [](int label) { return label != kNoRegion; });
}

// Regions of a patch whose shapes their points do not reject at the noise that they show
// themselves, in the patch's numbers.
std::vector<Region> RegionsAtOwn(RegionPoints& patch,
                                 double sigma,
                                 const Progress& progress,
                                 ThreadPool& pool) {
  std::vector<Region> regions = RegionsAt(patch, sigma, progress, pool).regions;
  std::erase_if(regions, [&](Region& region) {
    const Eigen::Matrix3Xd points = patch.points(Eigen::all, region.points);
    const double own =
        std::max(patch.rounding, RobustScale(SurfaceDistances(region.shape, points, pool)));
    if (!TestShape(patch, region.points, region.shape, own).passed) return true;
    std::erase_if(region.points, [&](int point) {
      return std::abs(region.shape.Distance(patch.points.col(point))) > kFarFromShape * own;
    });
    return std::ssize(region.points) < kFewestPoints;
  });
  return regions;
}

// Regions of patches that are left, each at its own noise: faces with more of it than others, as
// those of facets where planes have none.
void TakeNoisier(const RegionPoints& data,
                 double sigma,
                 RegionLabels& labels,
                 const Progress& progress,
                 ThreadPool& pool) {
  std::vector<int> free(labels.label.size(), kNoRegion);
  for (std::size_t k = 0; k < free.size(); ++k)
    if (labels.label[k] == kNoRegion) free[k] = 0;
  for (std::vector<int>& patch : ComponentsOf(data, free)) {
    if (std::ssize(patch) < kFewestPoints) continue;
    std::sort(patch.begin(), patch.end());
    RegionPoints part = PartOf(data, patch, data.spacing, pool);
    const NeighbourIndex index(part.points, pool);
    const double noise = MeasureCloud(part.points, index, {.find_outliers = false}, pool).noise;
    if (!(noise > kNoisier * sigma)) continue;
    for (Region& region : RegionsAtOwn(part, noise, progress, pool)) {
      for (int& point : region.points) point = patch[std::size_t(point)];
      Append(std::move(region), labels);
    }
  }
}

FoundRegions AtTheirNoise(RegionPoints& data,
                          double tolerance,
                          const Progress& progress,
                          ThreadPool& pool) {
  constexpr double kNearer = 0.7;  // of the noise assumed: regions at it have looser borders
  const double assumed = std::max(data.noise, tolerance / kFarFromShape);
  FoundRegions found{RegionsAt(data, assumed, progress, pool), assumed};
  found.sigma = SigmaOf(data, found.labels, assumed);
  if (tolerance > 0 || !(found.sigma < kNearer * assumed)) return found;
  FoundRegions sharper{RegionsAt(data, found.sigma, progress, pool), found.sigma};
  sharper.sigma = SigmaOf(data, sharper.labels, found.sigma);
  const auto before = static_cast<double>(Explained(found.labels));
  const bool as_many = static_cast<double>(Explained(sharper.labels)) >= kAsMany * before;
  return as_many ? sharper : found;
}

}  // namespace

FoundRegions FindRegions(RegionPoints& data,
                         double tolerance,
                         const Progress& progress,
                         ThreadPool& pool) {
  FoundRegions found = AtTheirNoise(data, tolerance, progress, pool);
  if (!(tolerance > 0)) TakeNoisier(data, found.sigma, found.labels, progress, pool);
  DissolvePieces(data, found.sigma, found.labels, pool);
  return found;
}

}  // namespace batten::internal
