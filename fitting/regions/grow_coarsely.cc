// SPDX-License-Identifier: MIT
#include "fitting/regions/grow_coarsely.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

namespace batten::internal {
namespace {

constexpr Eigen::Index kMost = 40000;  // points that regions grow over

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
                          const Progress& progress,
                          ThreadPool& pool) {
  if (data.size() <= kMost) return GrowRegions(data, sigma, progress, pool);
  constexpr double kWider = 1.2;
  double side = data.spacing * std::sqrt(double(data.size()) / double(kMost));
  std::vector<int> some = OnePerCube(data.points, side);
  while (std::ssize(some) > kMost) some = OnePerCube(data.points, side *= kWider);
  RegionLabels labels = GrowRegions(PartOf(data, some, side, pool), sigma, progress, pool);
  const std::vector<int> of_some = std::move(labels.label);
  labels.label.assign(static_cast<std::size_t>(data.size()), kNoRegion);
  for (std::size_t k = 0; k < some.size(); ++k) labels.label[std::size_t(some[k])] = of_some[k];
  for (Region& region : labels.regions) {
    for (int& point : region.points) point = some[std::size_t(point)];
  }
  return labels;
}

}  // namespace batten::internal
