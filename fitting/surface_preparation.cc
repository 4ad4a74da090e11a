// SPDX-License-Identifier: MIT
#include "batten/fitting/surface_preparation.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/choose_base.h"
#include "batten/fitting/neighbours.h"
#include "batten/fitting/stopwatch.h"

namespace batten {

void SortByPlace(PreparedCloud& prepared) {
  const PointCloud& cloud = prepared.merged.cloud;
  const SurfaceBase& base = prepared.base;
  constexpr double kPointsPerPlace = 16;
  const double side = std::sqrt(base.length_u * base.length_v * kPointsPerPlace /
                                static_cast<double>(cloud.size()));
  const auto columns = static_cast<Eigen::Index>(base.length_v / side) + 1;
  std::vector<std::pair<Eigen::Index, Eigen::Index>> keys(static_cast<size_t>(cloud.size()));
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(base.parameters(0, k) / side);
    const auto column =
        std::min(columns - 1, static_cast<Eigen::Index>(base.parameters(1, k) / side));
    keys[static_cast<size_t>(k)] = {row * columns + (row % 2 == 0 ? column : columns - 1 - column),
                                    k};
  }
  std::sort(keys.begin(), keys.end());
  std::vector<Eigen::Index> order, rank(keys.size());
  order.reserve(keys.size());
  for (const auto& [key, k] : keys) {
    rank[static_cast<size_t>(k)] = static_cast<Eigen::Index>(order.size());
    order.push_back(k);
  }
  prepared.merged.cloud = cloud.Picked(order);
  for (Eigen::Index& place : prepared.merged.place) place = rank[static_cast<size_t>(place)];
  prepared.base.parameters = base.parameters(Eigen::all, order).eval();
  prepared.reached = prepared.reached(order).eval();
  prepared.used = prepared.used(order).eval();
  prepared.statistics.outliers = prepared.statistics.outliers(order).eval();
}

PreparedCloud PrepareCloud(const PointCloud& cloud,
                           const SurfaceFitOptions& options,
                           ThreadPool& pool) {
  PreparedCloud prepared;
  Report(options.progress, "prepare", 0);
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
  prepared.statistics = MeasureCloud(points.points(), index, statistics, pool, options.progress);
  Report(options.progress, "parameterize", 0);
  Stopwatch watch;
  BaseChoice choice = ChooseBase(points, index, prepared.statistics, options, pool);
  prepared.base = std::move(choice.base);
  prepared.reached = std::move(choice.reached);
  prepared.warnings = std::move(choice.warnings);
  prepared.used = prepared.reached && !prepared.statistics.outliers;
  SortByPlace(prepared);
  prepared.base_seconds = watch.Lap();
  return prepared;
}

}  // namespace batten
