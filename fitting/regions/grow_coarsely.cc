// SPDX-License-Identifier: MIT
#include "fitting/regions/grow_coarsely.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include "batten/fitting/neighbours.h"
#include "fitting/regions/region_shape.h"

namespace batten::internal {
namespace {

constexpr Eigen::Index kMost = 40000;  // points that regions grow over
constexpr int kNear = 4;               // of them, whose regions a point may be of

// Of each cube of a grid that has points the one nearest to its middle.
std::vector<int> OnePerCube(const Eigen::Matrix3Xd& points, double side) {
  struct Place {
    std::array<std::int64_t, 3> cube;
    double off;
    int point;
  };
  std::vector<Place> places;
  places.reserve(static_cast<std::size_t>(points.cols()));
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const Eigen::Array3d at = points.col(k).array() / side, cube = at.floor();
    places.push_back({{static_cast<std::int64_t>(cube[0]),
                       static_cast<std::int64_t>(cube[1]),
                       static_cast<std::int64_t>(cube[2])},
                      (at - cube - 0.5).matrix().squaredNorm(),
                      static_cast<int>(k)});
  }
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
    return std::tie(a.cube, a.off, a.point) < std::tie(b.cube, b.off, b.point);
  });
  std::vector<int> some;
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (k == 0 || places[k].cube != places[k - 1].cube) some.push_back(places[k].point);
  }
  std::sort(some.begin(), some.end());
  return some;
}

}  // namespace

RegionLabels GrowCoarsely(const RegionPoints& data,
                          double sigma,
                          int fewest,
                          const Progress& progress,
                          ThreadPool& pool) {
  if (data.size() <= kMost) return GrowRegions(data, sigma, fewest, progress, pool);
  constexpr double kWider = 1.2;
  double side = data.spacing * std::sqrt(double(data.size()) / double(kMost));
  std::vector<int> some = OnePerCube(data.points, side);
  while (std::ssize(some) > kMost) some = OnePerCube(data.points, side *= kWider);
  RegionPoints part = PartOf(data, some, side, pool);
  RegionLabels coarse = GrowRegions(part, sigma, fewest, progress, pool);
  RegionLabels labels;
  labels.label.assign(static_cast<std::size_t>(data.size()), kNoRegion);
  const NeighbourIndex index(part.points, pool);
  const std::vector<int> nearest = index.Nearest(data.points, kNear);
  pool.For(data.size(), 1024, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (auto k = begin; k < end; ++k) {
      double least = kFarFromShape * sigma;
      for (int j = 0; j < kNear; ++j) {
        const int region = coarse.label[std::size_t(nearest[std::size_t(k * kNear + j)])];
        if (region == kNoRegion) continue;
        const double off =
            std::abs(coarse.regions[std::size_t(region)].shape.Distance(data.points.col(k)));
        if (!(off <= least)) continue;
        least = off;
        labels.label[std::size_t(k)] = region;
      }
    }
  });
  for (Region& region : coarse.regions) region.points.clear();
  labels.regions = std::move(coarse.regions);
  for (std::size_t k = 0; k < labels.label.size(); ++k) {
    if (labels.label[k] != kNoRegion)
      labels.regions[std::size_t(labels.label[k])].points.push_back(static_cast<int>(k));
  }
  return labels;
}

}  // namespace batten::internal
