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
  constexpr double kMostPlaces = 1e9;  // along a side, however long and narrow the domain is
  const double side = std::sqrt(base.length_u) * std::sqrt(base.length_v) *
                      std::sqrt(kPointsPerPlace / static_cast<double>(cloud.size()));
  const auto place = [&](double length) {
    return static_cast<Eigen::Index>(std::clamp(length / side, 0.0, kMostPlaces));
  };
  const Eigen::Index columns = place(base.length_v) + 1;
  std::vector<std::pair<Eigen::Index, Eigen::Index>> keys(static_cast<size_t>(cloud.size()));
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    const Eigen::Index row = place(base.parameters(0, k));
    const Eigen::Index column = std::min(columns - 1, place(base.parameters(1, k)));
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
  for (Eigen::Index& at : prepared.merged.place) at = rank[static_cast<size_t>(at)];
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
