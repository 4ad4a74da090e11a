// SPDX-License-Identifier: MIT
#include "fitting/surface/surface_preparation.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/neighbours.h"
#include "batten/fitting/refused_data.h"
#include "fitting/cloud/local_outlier_factor.h"
#include "fitting/core/input_summary.h"
#include "fitting/core/rules.h"
#include "fitting/core/shared_constants.h"
#include "fitting/surface/base_beside_clutter.h"

namespace batten::internal {

namespace {

// Indices in the order of their keys, of equal ones the lesser index first. O(n) where the keys are
// below a few times their number, O(n log n) else.
std::vector<Eigen::Index> OrderOf(const std::vector<std::int64_t>& keys, std::int64_t key_end) {
  constexpr std::int64_t kCountersPerKey = 2;
  const auto size = std::ssize(keys);
  std::vector<Eigen::Index> order(keys.size());
  if (key_end > kCountersPerKey * size) {
    std::iota(order.begin(), order.end(), Eigen::Index{0});
    std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
      return keys[static_cast<size_t>(a)] < keys[static_cast<size_t>(b)];
    });
    return order;
  }
  std::vector<Eigen::Index> next(static_cast<size_t>(key_end) + 1);
  for (const std::int64_t key : keys) ++next[static_cast<size_t>(key) + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  for (Eigen::Index k = 0; k < size; ++k)
    order[static_cast<size_t>(next[static_cast<size_t>(keys[static_cast<size_t>(k)])]++)] = k;
  return order;
}

}  // namespace

void SortByPlace(PreparedCloud& prepared) {
  const PointCloud& cloud = prepared.merged.cloud;
  const Parameterization& base = prepared.base;
  constexpr double kPointsPerPlace = 16;
  constexpr double kMostPlaces = 1e9;  // along a side, however long and narrow the domain is
  const double side = std::sqrt(base.length_u) * std::sqrt(base.length_v) *
                      std::sqrt(kPointsPerPlace / static_cast<double>(cloud.size()));
  const auto place = [&](double length) {
    return static_cast<std::int64_t>(std::clamp(length / side, 0.0, kMostPlaces));
  };
  const std::int64_t columns = place(base.length_v) + 1;
  std::vector<std::int64_t> keys(static_cast<size_t>(cloud.size()));
  std::int64_t rows = 0;
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    const std::int64_t row = place(base.parameters(0, k));
    const std::int64_t column = std::min(columns - 1, place(base.parameters(1, k)));
    rows = std::max(rows, row + 1);
    keys[static_cast<size_t>(k)] = row * columns + (row % 2 == 0 ? column : columns - 1 - column);
  }
  const std::vector<Eigen::Index> order = OrderOf(keys, rows * columns);
  std::vector<std::int64_t>& rank = keys;  // no longer needed
  for (size_t i = 0; i < order.size(); ++i)
    rank[static_cast<size_t>(order[i])] = static_cast<std::int64_t>(i);
  prepared.merged.cloud = cloud.Picked(order);
  for (Eigen::Index& at : prepared.merged.place) at = rank[static_cast<size_t>(at)];
  prepared.base.parameters = base.parameters(Eigen::all, order).eval();
  prepared.reached = prepared.reached(order).eval();
  prepared.used = prepared.used(order).eval();
  prepared.statistics.outliers = prepared.statistics.outliers(order).eval();
  std::vector<int> parts;
  if (!prepared.set_aside.empty())
    for (const Eigen::Index k : order) parts.push_back(prepared.set_aside[static_cast<size_t>(k)]);
  prepared.set_aside = std::move(parts);
}

namespace {

// Makes the base's parameters symmetric.
void MakeSymmetric(CloudSymmetry& symmetry,
                   const MergedCloud& merged,
                   ParameterizationChoice& choice) {
  std::vector<Eigen::Index> twins(static_cast<size_t>(merged.cloud.size()));
  for (size_t k = 0; k < merged.place.size(); ++k)
    twins[static_cast<size_t>(merged.place[k])] =
        merged.place[static_cast<size_t>(symmetry.twins[k])];
  SymmetricBase symmetric =
      SymmetricParameters(choice.base, merged.cloud, choice.reached, symmetry.plane, twins);
  symmetric.base.why += "; symmetric about the plane given";
  choice.base = std::move(symmetric.base);
  symmetry.reflected = symmetric.reflected;
}

void TakeBase(PreparedCloud& prepared,
              const NeighbourIndex& index,
              const SurfaceFitOptions& options,
              ThreadPool& pool) {
  auto [base, set_aside] =
      ChooseBesideClutter(prepared.merged.cloud,
                          index,
                          options,
                          options.keep_outliers || prepared.symmetry.has_value(),
                          pool,
                          prepared.statistics);
  auto& [choice, conditions] = base;
  prepared.set_aside = std::move(set_aside);
  prepared.conditions = std::move(conditions);
  if (prepared.symmetry) MakeSymmetric(*prepared.symmetry, prepared.merged, choice);
  prepared.base = std::move(choice.base);
  prepared.reached = std::move(choice.reached);
  prepared.warnings = std::move(choice.warnings);
  prepared.candidates = std::move(choice.candidates);
  prepared.used = prepared.reached && !prepared.statistics.outliers;
  SortByPlace(prepared);
}

// Removes isolated points where there are outliers: those beside the shape's edges look like its
// continuation and are found by isolation only.
void FlagOutliers(const PointCloud& points, CloudStatistics& statistics, ThreadPool& pool) {
  const double share =
      static_cast<double>(statistics.outlier_count) / static_cast<double>(points.size());
  if (!Acts(Rule::kIsolatedPoints) || share <= kOutlierShareForLoss) return;
  statistics.outliers =
      !NonIsolatedPoints(points.points(), !statistics.outliers, pool, share > kManyStrays);
  statistics.outlier_count = statistics.outliers.count();
}

}  // namespace

PreparedCloud PrepareCloud(const PointCloud& cloud,
                           const SurfaceFitOptions& options,
                           ThreadPool& pool,
                           StageClock& clock,
                           std::optional<CloudSymmetry> symmetry) {
  PreparedCloud prepared;
  prepared.symmetry = std::move(symmetry);
  Report(options.progress, "prepare", 0);
  if (cloud.size() == 0) throw RefusedData("the cloud holds no points");
  prepared.merged = MergeDuplicates(cloud);
  const PointCloud& points = prepared.merged.cloud;
  if (points.size() < kFewestSurfacePoints) {
    throw RefusedData("a surface needs at least 4 different points; there are " +
                      std::to_string(points.size()));
  }
  const NeighbourIndex index(points.points(), pool);
  CloudStatisticsOptions statistics;
  statistics.seed = options.seed;
  prepared.statistics = MeasureCloud(points.points(), index, statistics, pool, options.progress);
  if (!options.keep_outliers) FlagOutliers(points, prepared.statistics, pool);
  Report(options.progress, "parameterize", 0);
  clock.Enter(&StageSeconds::parameterize);
  TakeBase(prepared, index, options, pool);
  return prepared;
}

FitReport StartReport(const PreparedCloud& prepared,
                      const PointCloud& cloud,
                      Eigen::Index duplicates,
                      int threads) {
  FitReport report;
  report.threads = threads;
  const CloudStatistics& measured = prepared.statistics;
  report.input = SummariseInput(cloud, duplicates, measured.spacing, measured.noise);
  report.geometry.base = prepared.base.name;
  report.geometry.base_why = prepared.base.why;
  if (prepared.base.plane) report.geometry.base_axes = prepared.base.plane->axes;
  report.warnings = prepared.warnings;
  report.base_candidates = prepared.candidates;
  return report;
}

}  // namespace batten::internal
