// SPDX-License-Identifier: MIT
#include "fitting/surface/base_beside_clutter.h"

#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/refused_data.h"
#include "fitting/cloud/connected_points.h"
#include "fitting/core/rules.h"
#include "fitting/parameterization/projection_overlap.h"

namespace batten::internal {
namespace {

// Whether points, with those that are no outliers, make about as few layers over a plane as those
// alone: heights beside the others, such as islands.
bool OneLayerWith(const PointMask& more,
                  const PointCloud& cloud,
                  const CloudStatistics& statistics,
                  const PlaneBase& plane) {
  constexpr double kMoreLayered = 0.01;  // share of the places
  const auto layered = [&](const PointMask& counted) {
    std::vector<Eigen::Index> some;
    for (Eigen::Index k = 0; k < counted.size(); ++k)
      if (counted[k]) some.push_back(k);
    return LayeredPlaces(cloud.points()(Eigen::all, some),
                         plane.origin,
                         plane.axes,
                         statistics.spacing,
                         std::tan(plane.steepness));
  };
  const PointMask inliers = !statistics.outliers;
  return layered(inliers || more) <= layered(inliers) + kMoreLayered;
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

ConditionedBase ChooseBesideClutter(const PointCloud& cloud,
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
  Chosen all = choose(statistics);
  if (all.FitsNoise() || keep_all || !Acts(Rule::kClutter)) return std::move(all).OrThrow();
  const PointMask small = SmallParts(cloud.points(), index, pool);
  const PointMask clutter = small && !statistics.outliers;
  CloudStatistics quiet = statistics;
  quiet.outliers = quiet.outliers || clutter;
  const auto beside = [&](const ConditionedBase& base) {
    const auto& plane = base.choice.base.plane;
    return plane && OneLayerWith(clutter, cloud, quiet, *plane);
  };
  if (!clutter.any() || (all.base && beside(*all.base))) return std::move(all).OrThrow();
  Chosen without = choose(quiet);
  if (!without.base || (all.base && (!without.FitsNoise() || beside(*without.base))))
    return std::move(all).OrThrow();
  statistics.outliers = quiet.outliers;
  ParameterizationChoice& choice = without.base->choice;
  choice.reached = choice.reached && !small;  // nor do they vote
  choice.warnings.push_back(std::to_string(clutter.count()) +
                            " points of small parts beside the largest were set aside before its "
                            "shape was chosen");
  return std::move(without).OrThrow();
}

}  // namespace batten::internal
