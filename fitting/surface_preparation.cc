// SPDX-License-Identifier: MIT
#include "batten/fitting/surface_preparation.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/neighbours.h"

namespace batten {
namespace {

// Puts points that are neighbours in the plane beside each other in memory: everything later goes
// through them cell by cell.
void SortByPlace(PreparedCloud& prepared) {
  const PointCloud& cloud = prepared.merged.cloud;
  const Eigen::Matrix3Xd local = prepared.base.ToFrame(cloud.points());
  constexpr double kPointsPerPlace = 16;
  const double side = std::sqrt(prepared.base.length_u * prepared.base.length_v * kPointsPerPlace /
                                static_cast<double>(cloud.size()));
  const auto columns = static_cast<Eigen::Index>(prepared.base.length_v / side) + 1;
  std::vector<std::pair<Eigen::Index, Eigen::Index>> keys(static_cast<size_t>(cloud.size()));
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(std::max(0.0, local(0, k)) / side);
    const auto column =
        std::min(columns - 1, static_cast<Eigen::Index>(std::max(0.0, local(1, k)) / side));
    keys[k] = {row * columns + (row % 2 == 0 ? column : columns - 1 - column), k};
  }
  std::sort(keys.begin(), keys.end());
  std::vector<Eigen::Index> order, rank(keys.size());
  order.reserve(keys.size());
  for (const auto& [key, k] : keys) {
    rank[k] = static_cast<Eigen::Index>(order.size());
    order.push_back(k);
  }
  prepared.merged.cloud = cloud.Picked(order);
  for (Eigen::Index& place : prepared.merged.place) place = rank[place];
  prepared.used = prepared.used(order).eval();
  prepared.statistics.outliers = prepared.statistics.outliers(order).eval();
}

}  // namespace

PreparedCloud PrepareCloud(const PointCloud& cloud,
                           const PreparationOptions& options,
                           ThreadPool& pool,
                           const Progress& progress) {
  PreparedCloud prepared;
  Report(progress, "prepare", 0);
  if (cloud.size() == 0) throw std::invalid_argument("the cloud holds no points");
  prepared.merged = MergeDuplicates(cloud);
  const PointCloud& points = prepared.merged.cloud;
  if (points.size() < 4) {
    throw std::invalid_argument("a surface needs at least 4 different points; there are " +
                                std::to_string(points.size()));
  }
  const NeighbourIndex index(points.points());
  CloudStatisticsOptions statistics;
  statistics.seed = options.seed;
  statistics.find_outliers = !options.keep_outliers;
  prepared.statistics = MeasureCloud(points.points(), index, statistics, pool, progress);
  prepared.used = !prepared.statistics.outliers;
  Report(progress, "parameterize", 0);
  const auto start = std::chrono::steady_clock::now();
  const double margin = prepared.statistics.spacing / 2 + 2 * prepared.statistics.noise;
  const PlaneBaseOptions base_options{.seed = options.seed};
  if (prepared.used.all()) {
    prepared.base =
        FindPlaneBase(points.points(), index, prepared.statistics.spacing, margin, base_options);
  } else {
    const PointCloud good = points.Subset(prepared.used);
    prepared.base = FindPlaneBase(good.points(),
                                  NeighbourIndex(good.points()),
                                  prepared.statistics.spacing,
                                  margin,
                                  base_options);
  }
  SortByPlace(prepared);
  prepared.base_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return prepared;
}

}  // namespace batten
