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

// Which points have another above or below over a plane, farther from them than their neighbours
// and the noise.
class LayersOver {
 public:
  LayersOver(const Eigen::Matrix3Xd& points, const PlaneBase& plane, ThreadPool& pool)
      : places_(plane.ToFrame(points)), plan_(Flat(places_)), over_(plan_, pool), pool_(pool) {}

  // Of some of the points, by their neighbours among them.
  std::vector<bool> ApartAmong(const std::vector<Eigen::Index>& some, double noise) const {
    constexpr int kNeighbours = 4, kOver = 3;
    constexpr double kApart = 2, kApartInNoise = 6;  // of the neighbours' distance
    const Eigen::Matrix3Xd own = places_(Eigen::all, some);
    const int each = static_cast<int>(std::min<Eigen::Index>(kNeighbours + 1, own.cols())),
              others = static_cast<int>(std::min<Eigen::Index>(kOver + 1, places_.cols()));
    const std::vector<int> near = NeighbourIndex(own, pool_).Nearest(own, each),
                           over = over_.Nearest(Flat(own), others);
    std::vector<bool> apart(some.size());
    for (Eigen::Index i = 0; i < own.cols(); ++i) {
      const double reach =
          (own.col(near[static_cast<size_t>((i + 1) * each - 1)]) - own.col(i)).norm();
      for (int n = 0; n < others; ++n) {
        const Eigen::Vector3d way =
            places_.col(over[static_cast<size_t>(i * others + n)]) - own.col(i);
        if (way.head<2>().norm() <= reach &&
            std::abs(way[2]) > kApart * reach + kApartInNoise * noise)
          apart[static_cast<size_t>(i)] = true;
      }
    }
    return apart;
  }

 private:
  static Eigen::Matrix3Xd Flat(Eigen::Matrix3Xd places) {
    places.row(2).setZero();
    return places;
  }

  Eigen::Matrix3Xd places_, plan_;
  NeighbourIndex over_;
  ThreadPool& pool_;
};

// Which small parts are no heights beside the others over a plane, as islands are: clearly more of
// their points than of the others have another above or below.
std::vector<bool> PartsInLayers(const std::vector<int>& parts,
                                const PointCloud& cloud,
                                const CloudStatistics& statistics,
                                const PlaneBase& plane,
                                ThreadPool& pool) {
  constexpr double kMore = 0.2;  // share of a part's points
  std::vector<Eigen::Index> inliers, small, large;
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    if (statistics.outliers[k]) continue;
    (parts[static_cast<size_t>(k)] >= 0 ? small : large).push_back(std::ssize(inliers));
    inliers.push_back(k);
  }
  const LayersOver layers(cloud.points()(Eigen::all, inliers), plane, pool);
  const std::vector<bool> apart = layers.ApartAmong(small, statistics.noise),
                          others = layers.ApartAmong(large, statistics.noise);
  const double usual = static_cast<double>(std::ranges::count(others, true)) /
                       static_cast<double>(std::max<size_t>(1, others.size()));
  const auto count = static_cast<size_t>(*std::ranges::max_element(parts) + 1);
  std::vector<double> all(count), layered(count);
  for (size_t i = 0; i < small.size(); ++i) {
    const auto part =
        static_cast<size_t>(parts[static_cast<size_t>(inliers[static_cast<size_t>(small[i])])]);
    ++all[part];
    layered[part] += apart[i];
  }
  std::vector<bool> in_layers(count);
  for (size_t part = 0; part < count; ++part)
    in_layers[part] = layered[part] > (usual + kMore) * all[part];
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
