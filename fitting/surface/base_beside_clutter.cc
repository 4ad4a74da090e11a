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
#include "fitting/core/mask_indices.h"
#include "fitting/core/rules.h"
#include "fitting/parameterization/projection_overlap.h"

namespace batten::internal {
namespace {

// The points but outliers far from others: those of rough places connect what is beside them.
PointMask NoStrays(const Eigen::Matrix3Xd& points,
                   const NeighbourIndex& index,
                   const CloudStatistics& statistics) {
  constexpr int kNeighbours = 6;
  constexpr double kFar = 5;  // spacings
  PointMask kept = !statistics.outliers;
  const std::vector<Eigen::Index> asked = IndicesOf(statistics.outliers);
  const int each = static_cast<int>(std::min<Eigen::Index>(kNeighbours + 1, points.cols()));
  const std::vector<int> near = index.Nearest(points(Eigen::all, asked), each);
  for (size_t i = 0; i < asked.size(); ++i) {
    const int last = near[(i + 1) * static_cast<size_t>(each) - 1];
    kept[asked[i]] = (points.col(last) - points.col(asked[i])).norm() <= kFar * statistics.spacing;
  }
  return kept;
}

// The share of some points of a cloud that have another of them above or below over a plane,
// farther from them than their neighbours and the noise.
double ShareInLayers(const std::vector<Eigen::Index>& some,
                     const PointCloud& cloud,
                     const PlaneBase& plane,
                     double noise,
                     ThreadPool& pool) {
  constexpr int kNeighbours = 4, kOver = 3;
  constexpr double kApart = 2, kApartInNoise = 6;  // of the neighbours' distance
  const Eigen::Matrix3Xd places = plane.ToFrame(cloud.points()(Eigen::all, some));
  Eigen::Matrix3Xd plan = places;
  plan.row(2).setZero();
  const int each = static_cast<int>(std::min<Eigen::Index>(kNeighbours + 1, places.cols())),
            others = static_cast<int>(std::min<Eigen::Index>(kOver + 1, places.cols()));
  const std::vector<int> near = NeighbourIndex(places, pool).Nearest(places, each),
                         over = NeighbourIndex(plan, pool).Nearest(plan, others);
  double apart = 0;
  for (Eigen::Index i = 0; i < places.cols(); ++i) {
    const int last = near[static_cast<size_t>((i + 1) * each - 1)];
    const double reach = (places.col(last) - places.col(i)).norm();
    bool found = false;
    for (int n = 0; n < others; ++n) {
      const Eigen::Vector3d way =
          places.col(over[static_cast<size_t>(i * others + n)]) - places.col(i);
      found |= way.head<2>().norm() <= reach &&
               std::abs(way[2]) > kApart * reach + kApartInNoise * noise;
    }
    apart += found;
  }
  return apart / std::max<double>(1, static_cast<double>(places.cols()));
}

// Which small parts are no heights beside the others, as islands are: all where they make more
// layers of them over a plane, else those that lie in layers themselves, clearly more than the
// others.
std::vector<bool> PartsInLayers(const std::vector<int>& parts,
                                const PointCloud& cloud,
                                const CloudStatistics& statistics,
                                const PlaneBase& plane,
                                ThreadPool& pool) {
  constexpr double kMore = 0.2, kMoreLayered = 0.01;  // shares of a part's points, of places
  const auto count = static_cast<size_t>(*std::ranges::max_element(parts) + 1);
  std::vector<std::vector<Eigen::Index>> small(count);
  std::vector<Eigen::Index> large, all;
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    const int part = parts[static_cast<size_t>(k)];
    if (part < 0 && statistics.outliers[k]) continue;
    (part >= 0 ? small[static_cast<size_t>(part)] : large).push_back(k);
    all.push_back(k);
  }
  const auto layered = [&](const std::vector<Eigen::Index>& some) {
    return LayeredPlaces(cloud.points()(Eigen::all, some),
                         plane.origin,
                         plane.axes,
                         statistics.spacing,
                         std::tan(plane.steepness));
  };
  if (layered(all) > layered(large) + kMoreLayered) return std::vector<bool>(count, true);
  const double others = ShareInLayers(large, cloud, plane, statistics.noise, pool);
  std::vector<bool> found(count);
  for (size_t part = 0; part < count; ++part)
    found[part] = ShareInLayers(small[part], cloud, plane, statistics.noise, pool) > others + kMore;
  return found;
}

// Keeps the marked parts.
void KeepParts(const std::vector<bool>& marked, std::vector<int>& parts) {
  for (int& part : parts)
    if (part >= 0 && !marked[static_cast<size_t>(part)]) part = -1;
  if (std::ranges::max_element(parts)[0] < 0) parts.clear();
}

// The points of parts.
PointMask Marked(const std::vector<int>& parts) {
  PointMask marked(std::ssize(parts));
  for (Eigen::Index k = 0; k < marked.size(); ++k) marked[k] = parts[static_cast<size_t>(k)] >= 0;
  return marked;
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
    parts = SmallParts(cloud.points(), NoStrays(cloud.points(), index, statistics), pool);
  Chosen all = choose(statistics);
  if (parts.empty()) return {std::move(all).OrThrow(), {}};
  const auto lie_in_layers = [&](const ConditionedBase& base) {
    if (const auto& plane = base.choice.base.plane)
      KeepParts(PartsInLayers(parts, cloud, statistics, *plane, pool), parts);
  };
  if (all.base) lie_in_layers(*all.base);
  if (parts.empty()) return {std::move(all).OrThrow(), {}};
  CloudStatistics quiet = statistics;
  quiet.outliers = statistics.outliers || Marked(parts);
  Chosen without = choose(quiet);
  if (!without.base) return {std::move(all).OrThrow(), {}};
  if (all.base) {
    // Beside a plane they lie over each other: no height field holds them all. A bent base that
    // holds them within the noise gives way to a plane only.
    const bool plane = without.base->choice.base.plane.has_value(), fits = without.FitsNoise();
    const bool serves = all.base->choice.base.plane ? true : fits && (plane || !all.FitsNoise());
    if (serves) lie_in_layers(*without.base);
    if (!serves || parts.empty()) return {std::move(all).OrThrow(), {}};
  }
  const PointMask small = Marked(parts);
  quiet.outliers = statistics.outliers || small;
  statistics.outliers = quiet.outliers;
  ParameterizationChoice& choice = without.base->choice;
  choice.reached = choice.reached && !small;  // nor do they vote
  choice.warnings.push_back(std::to_string(small.count()) +
                            " points of small parts beside the largest were set aside before its "
                            "shape was chosen");
  return {std::move(without).OrThrow(), std::move(parts)};
}

}  // namespace batten::internal
