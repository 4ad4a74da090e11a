// SPDX-License-Identifier: MIT
#include "fitting/surface/base_beside_clutter.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/refused_data.h"
#include "fitting/cloud/connected_points.h"
#include "fitting/core/rules.h"

namespace batten::internal {
namespace {

// Which small parts are no heights beside the others over a plane, as islands are: many of their
// points have another above or below, farther from them than their neighbours and the noise.
std::vector<bool> PartsInLayers(const std::vector<int>& parts,
                                const PointCloud& cloud,
                                const CloudStatistics& statistics,
                                const PlaneBase& plane,
                                ThreadPool& pool) {
  constexpr int kNeighbours = 4, kBelow = 3;
  constexpr double kApart = 2, kApartInNoise = 6;  // of the neighbours' distance
  constexpr double kInLayers = 0.2;                // share of a part's points
  std::vector<Eigen::Index> inliers, small;        // small: among the inliers
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    if (statistics.outliers[k]) continue;
    if (parts[static_cast<size_t>(k)] >= 0) small.push_back(std::ssize(inliers));
    inliers.push_back(k);
  }
  const Eigen::Matrix3Xd places = plane.ToFrame(cloud.points()(Eigen::all, inliers));
  Eigen::Matrix3Xd plan = places;
  plan.row(2).setZero();
  const Eigen::Matrix3Xd own = places(Eigen::all, small), own_plan = plan(Eigen::all, small);
  const int each = static_cast<int>(std::min<Eigen::Index>(kNeighbours + 1, own.cols())),
            below = static_cast<int>(std::min<Eigen::Index>(kBelow + 1, plan.cols()));
  const std::vector<int> near = NeighbourIndex(own, pool).Nearest(own, each),
                         over = NeighbourIndex(plan, pool).Nearest(own_plan, below);
  const auto count = static_cast<size_t>(*std::ranges::max_element(parts) + 1);
  std::vector<double> all(count), layered(count);
  for (Eigen::Index i = 0; i < own.cols(); ++i) {
    const double reach =
        (own.col(near[static_cast<size_t>((i + 1) * each - 1)]) - own.col(i)).norm();
    bool apart = false;
    for (int n = 0; n < below; ++n) {
      const Eigen::Vector3d way = places.col(over[static_cast<size_t>(i * below + n)]) - own.col(i);
      apart |= way.head<2>().norm() <= reach &&
               std::abs(way[2]) > kApart * reach + kApartInNoise * statistics.noise;
    }
    const auto part = static_cast<size_t>(
        parts[static_cast<size_t>(inliers[static_cast<size_t>(small[static_cast<size_t>(i)])])]);
    ++all[part];
    layered[part] += apart;
  }
  std::vector<bool> in_layers(count);
  for (size_t part = 0; part < count; ++part)
    in_layers[part] = layered[part] > kInLayers * all[part];
  return in_layers;
}

// Keeps the marked parts.
void KeepParts(const std::vector<bool>& marked, std::vector<int>& parts) {
  for (int& part : parts)
    if (part >= 0 && !marked[static_cast<size_t>(part)]) part = -1;
  if (std::ranges::max_element(parts)[0] < 0) parts.clear();
}

// A base, or why there is none.
struct Chosen {
  std::optional<ConditionedBase> base;
  std::optional<RefusedData> refusal;

  ConditionedBase OrThrow() && {
    if (refusal) throw RefusedData(*refusal);
    return std::move(*base);
  }
  bool FitsNoise() const { return base && base->choice.fits_noise; }
};

}  // namespace

BaseBesideClutter ChooseBesideClutter(const PointCloud& cloud,
                                      const NeighbourIndex& index,
                                      const SurfaceFitOptions& options,
                                      bool keep_all,
                                      ThreadPool& pool,
                                      CloudStatistics& statistics) {
  const auto choose = [&](const CloudStatistics& with) {
    Chosen chosen;
    try {
      chosen.base = ChooseConditionedBase(cloud, index, with, options, pool);
    } catch (const RefusedData& why) {
      chosen.refusal = why;
    }
    return chosen;
  };
  std::vector<int> parts;
  if (!keep_all && Acts(Rule::kClutter))
    parts = SmallParts(cloud.points(), !statistics.outliers, index, pool);
  Chosen all = choose(statistics);
  if (parts.empty()) return {std::move(all).OrThrow(), {}};
  const auto lie_in_layers = [&](const ConditionedBase& base) {
    if (const auto& plane = base.choice.base.plane)
      KeepParts(PartsInLayers(parts, cloud, statistics, *plane, pool), parts);
  };
  if (all.base) lie_in_layers(*all.base);
  const bool fits = all.FitsNoise() && !all.base->choice.base.plane;
  if (parts.empty() || fits) return {std::move(all).OrThrow(), {}};
  PointMask small(cloud.size());
  for (Eigen::Index k = 0; k < small.size(); ++k) small[k] = parts[static_cast<size_t>(k)] >= 0;
  CloudStatistics quiet = statistics;
  quiet.outliers = quiet.outliers || small;
  Chosen without = choose(quiet);
  if (!without.base) return {std::move(all).OrThrow(), {}};
  if (all.base) {
    // Beside a plane they lie over each other: no height field holds them all.
    const bool serves = all.base->choice.base.plane || without.base->choice.fits_noise;
    lie_in_layers(*without.base);
    if (!serves || parts.empty()) return {std::move(all).OrThrow(), {}};
  }
  statistics.outliers = quiet.outliers;
  ParameterizationChoice& choice = without.base->choice;
  choice.reached = choice.reached && !small;  // nor do they vote
  choice.warnings.push_back(std::to_string(small.count()) +
                            " points of small parts beside the largest were set aside before its "
                            "shape was chosen");
  return {std::move(without).OrThrow(), std::move(parts)};
}

}  // namespace batten::internal
