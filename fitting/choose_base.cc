// SPDX-License-Identifier: MIT
#include "batten/fitting/choose_base.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/base_score.h"
#include "batten/fitting/plan_parts.h"
#include "batten/fitting/plane_base.h"
#include "batten/fitting/settled_parameters.h"
#include "batten/fitting/sheet_base.h"

namespace batten {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kOverlapToWarn = 0.02;
constexpr double kOverlapToRefuse = 0.15;
constexpr double kGentle = std::numbers::pi / 4;  // a plane serves without question up to this
constexpr double kAtNoise = 1.5;
constexpr double kBetterOnRoughGround = 0.5;  // where the plane's surface is not at the noise
constexpr double kApartToRefuse = 0.1;
constexpr double kHopeless = 1.1;
constexpr double kVerySteep = 75 / kDegrees;
constexpr double kAsGood = 1.01;
constexpr double kClearlyBetter = 0.995;  // a sheet's score against a plane's

SurfaceBase OverPlane(const PlaneBase& plane, const Eigen::Matrix3Xd& points) {
  SurfaceBase base;
  base.name = "plane";
  base.shape = "a smooth height field";
  base.length_u = plane.length_u;
  base.length_v = plane.length_v;
  const Eigen::Matrix3Xd local = plane.ToFrame(points);
  base.parameters.resize(2, points.cols());
  base.parameters.row(0) = local.row(0).cwiseMax(0.0).cwiseMin(plane.length_u);
  base.parameters.row(1) = local.row(1).cwiseMax(0.0).cwiseMin(plane.length_v);
  base.plane = plane;
  return base;
}

// The sheet laid out flat; points that stand out have no place.
struct Laid {
  SurfaceBase base;
  PointMask reached;
  std::string refusal;  // empty where it serves
  bool one_sided = false;
};

Laid OverSheet(const Eigen::Matrix3Xd& points,
               const std::vector<Eigen::Index>& kept,
               const Eigen::Matrix3Xd& good,
               const NeighbourIndex& index,
               const CloudStatistics& statistics,
               double margin,
               ThreadPool& pool,
               const Progress& progress) {
  SheetBase sheet =
      FlattenSheet(good, index, statistics.spacing, statistics.noise, margin, {}, pool, progress);
  Laid laid;
  laid.refusal = sheet.refusal;
  laid.one_sided = !sheet.orientation_consistent;
  laid.reached = PointMask::Constant(points.cols(), false);
  laid.base.name = "sheet";
  laid.base.shape = "a smooth sheet";
  laid.base.length_u = sheet.length_u;
  laid.base.length_v = sheet.length_v;
  laid.base.parameters = Eigen::Matrix2Xd::Zero(2, points.cols());
  for (size_t k = 0; k < kept.size(); ++k) {
    laid.base.parameters.col(kept[k]) = sheet.parameters.col(static_cast<Eigen::Index>(k));
    laid.reached[kept[k]] = sheet.reached[static_cast<Eigen::Index>(k)];
  }
  return laid;
}

}  // namespace

BaseChoice ChooseBase(const PointCloud& cloud,
                      const NeighbourIndex& index,
                      const CloudStatistics& statistics,
                      const SurfaceFitOptions& options,
                      ThreadPool& pool) {
  const Eigen::Matrix3Xd& points = cloud.points();
  const double margin = statistics.spacing / 2 + 2 * statistics.noise;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    if (!statistics.outliers[k]) kept.push_back(k);
  }
  const bool all = static_cast<Eigen::Index>(kept.size()) == points.cols();
  const Eigen::Matrix3Xd some = all ? Eigen::Matrix3Xd(3, 0) : points(Eigen::all, kept).eval();
  const Eigen::Matrix3Xd& good = all ? points : some;
  std::optional<NeighbourIndex> own;
  if (!all) own.emplace(good);
  const NeighbourIndex& near = all ? index : *own;

  const PlaneBase plane =
      FindPlaneBase(good, near, statistics.spacing, margin, {.seed = options.seed});
  const std::string layers = "they lie over each other in " +
                             std::to_string(std::lround(100 * plane.overlap)) + " % of places";
  const std::string slope = std::to_string(std::lround(plane.steepness * kDegrees)) + " degrees";
  const Eigen::Matrix3Xd plan = plane.ToFrame(good);
  const double apart = ShareApart(plan.topRows<2>(), options.seed);
  if (apart > kApartToRefuse) {
    throw std::invalid_argument(std::to_string(std::lround(100 * apart)) +
                                " % of the points lie far apart from the others: a surface is one "
                                "piece; fit one part of the cloud at a time (--box, --where)");
  }
  BaseChoice choice;
  choice.reached = PointMask::Constant(points.cols(), true);
  choice.base = OverPlane(plane, points);
  choice.base.why = options.base == BaseShape::kPlane
                        ? "asked for"
                        : "the points are a height field, inclined " + slope + " or less";
  const bool plane_possible = plane.overlap <= kOverlapToRefuse;
  if (options.base == BaseShape::kAuto && plane.overlap <= kOverlapToWarn &&
      plane.steepness <= kGentle) {
    return choice;
  }
  std::string refusal = "seen from any side, " + layers +
                        ": the points are not a height field over a plane; --base sheet lays a "
                        "bent sheet out flat, --box takes a part of the cloud";
  if (options.base != BaseShape::kPlane) {
    Laid laid = OverSheet(points, kept, good, near, statistics, margin, pool, options.progress);
    refusal = laid.refusal;
    const bool asked_for = options.base == BaseShape::kSheet;
    const bool no_choice = asked_for || !plane_possible;
    const BaseScore score(cloud, kept, options, pool);
    const double of_plane = no_choice ? 0 : score.Of(choice.base).score;
    const double noise = kAtNoise * statistics.noise;
    const bool plane_is_right = !no_choice && of_plane <= noise * noise;
    // A one-sided sheet has no height field either; steep ground only looks like one.
    if (laid.one_sided && !plane_is_right) throw std::invalid_argument(refusal);
    if (laid.refusal.empty()) {
      laid.base.why = asked_for ? "asked for"
                      : plane.overlap > kOverlapToWarn
                          ? "seen from any side, " + layers
                          : "seen from any side, the points are inclined up to " + slope +
                                ", and laid out flat they are predicted better";
      // Settling gains a few hundredths, not more.
      const bool hopeless = !no_choice && score.Of(laid.base).score > kHopeless * of_plane;
      const bool settled =
          !hopeless && SettleParameters(laid.base, cloud, laid.reached, score, pool);
      // Over steep places a plane's cells are long: a tie goes to the sheet there.
      const double better = !plane_is_right                ? kBetterOnRoughGround
                            : plane.steepness > kVerySteep ? kAsGood
                                                           : kClearlyBetter;
      if (no_choice || (!hopeless && score.Of(laid.base).score < better * of_plane)) {
        if (settled) laid.base.why += "; parameters settled on a coarse surface";
        return {std::move(laid.base), std::move(laid.reached), {}};
      }
      choice.base.why += "; laid out flat, points are not predicted clearly better";
    } else if (asked_for) {
      throw std::invalid_argument(refusal);
    }
  }
  if (!plane_possible) throw std::invalid_argument(refusal);
  if (plane.overlap > kOverlapToWarn) {
    choice.warnings.push_back("seen from any side, " + layers +
                              ": a height field goes between the layers there");
  }
  return choice;
}

}  // namespace batten
