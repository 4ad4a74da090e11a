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
constexpr double kHopeless = 1.1;  // times the plane's score: no settling makes up for that
constexpr double kVerySteep = 75 / kDegrees;
constexpr double kAsGood = 1.01;          // a sheet's score against a plane's, on steep places
constexpr double kClearlyBetter = 0.995;  // elsewhere

std::string Percent(double share) { return std::to_string(std::lround(100 * share)) + " %"; }

// The bases a cloud may be fitted over, and the choice between them; members are what every step
// needs of the points.
class BaseChooser {
 public:
  BaseChooser(const PointCloud& cloud,
              const NeighbourIndex& index,
              const CloudStatistics& statistics,
              const SurfaceFitOptions& options,
              ThreadPool& pool)
      : cloud_(cloud), statistics_(statistics), options_(options), pool_(pool) {
    for (Eigen::Index k = 0; k < cloud.size(); ++k) {
      if (!statistics.outliers[k]) kept_.push_back(k);
    }
    const bool all = static_cast<Eigen::Index>(kept_.size()) == cloud.size();
    if (!all) {
      some_ = cloud.points()(Eigen::all, kept_);
      own_index_.emplace(some_);
    }
    good_ = all ? &cloud.points() : &some_;
    index_ = all ? &index : &*own_index_;
    margin_ = statistics.spacing / 2 + 2 * statistics.noise;
    plane_ = FindPlaneBase(*good_, *index_, statistics.spacing, margin_, {.seed = options.seed});
    layers_ =
        "seen from any side, they lie over each other in " + Percent(plane_.overlap) + " of places";
    slope_ = std::to_string(std::lround(plane_.steepness * kDegrees)) + " degrees";
  }

  BaseChoice Choose() {
    RefuseParts();
    BaseChoice plane = OverPlane();
    if (options_.base == BaseShape::kAuto && plane_.overlap <= kOverlapToWarn &&
        plane_.steepness <= kGentle) {
      return plane;
    }
    std::string refusal = layers_ +
                          ": the points are not a height field over a plane; --base sheet lays a "
                          "bent sheet out flat, --box takes a part of the cloud";
    if (options_.base != BaseShape::kPlane) {
      BaseChoice sheet = OverSheet(refusal);
      if (TakesSheet(plane, sheet, refusal)) return sheet;
    }
    if (!plane_possible()) throw std::invalid_argument(refusal);
    if (plane_.overlap > kOverlapToWarn) {
      plane.warnings.push_back(layers_ + ": a height field goes between the layers there");
    }
    return plane;
  }

 private:
  bool plane_possible() const { return plane_.overlap <= kOverlapToRefuse; }

  void RefuseParts() const {
    const Eigen::Matrix3Xd plan = plane_.ToFrame(*good_);
    const double apart = ShareApart(plan.topRows<2>(), options_.seed);
    if (apart <= kApartToRefuse) return;
    throw std::invalid_argument(Percent(apart) +
                                " of the points lie far apart from the others: a surface is one "
                                "piece; fit one part of the cloud at a time (--box, --where)");
  }

  BaseChoice OverPlane() const {
    SurfaceBase base;
    base.name = "plane";
    base.why = options_.base == BaseShape::kPlane
                   ? "asked for"
                   : "the points are a height field, inclined " + slope_ + " or less";
    base.shape = "a smooth height field";
    base.length_u = plane_.length_u;
    base.length_v = plane_.length_v;
    const Eigen::Matrix3Xd local = plane_.ToFrame(cloud_.points());
    base.parameters.resize(2, cloud_.size());
    base.parameters.row(0) = local.row(0).cwiseMax(0.0).cwiseMin(plane_.length_u);
    base.parameters.row(1) = local.row(1).cwiseMax(0.0).cwiseMin(plane_.length_v);
    base.plane = plane_;
    return {std::move(base), PointMask::Constant(cloud_.size(), true), {}};
  }

  // The sheet laid out flat; points that stand out have no place. `refusal` is empty where it
  // serves.
  BaseChoice OverSheet(std::string& refusal) {
    const SheetBase sheet = FlattenSheet(*good_,
                                         *index_,
                                         statistics_.spacing,
                                         statistics_.noise,
                                         margin_,
                                         {},
                                         pool_,
                                         options_.progress);
    refusal = sheet.refusal;
    one_sided_ = !sheet.orientation_consistent;
    BaseChoice laid;
    laid.reached = PointMask::Constant(cloud_.size(), false);
    laid.base.name = "sheet";
    laid.base.shape = "a smooth sheet";
    laid.base.length_u = sheet.length_u;
    laid.base.length_v = sheet.length_v;
    laid.base.parameters = Eigen::Matrix2Xd::Zero(2, cloud_.size());
    for (size_t k = 0; k < kept_.size(); ++k) {
      const auto from = static_cast<Eigen::Index>(k);
      laid.base.parameters.col(kept_[k]) = sheet.parameters.col(from);
      laid.reached[kept_[k]] = sheet.reached[from];
    }
    laid.base.why = options_.base == BaseShape::kSheet ? "asked for"
                    : plane_.overlap > kOverlapToWarn
                        ? layers_
                        : "seen from any side, the points are inclined up to " + slope_ +
                              ", and laid out flat they are predicted better";
    return laid;
  }

  // Whether the sheet is taken, its parameters settled where that pays; throws where neither it nor
  // the plane can be.
  bool TakesSheet(BaseChoice& plane, BaseChoice& sheet, const std::string& refusal) const {
    const bool asked_for = options_.base == BaseShape::kSheet;
    const bool no_choice = asked_for || !plane_possible();
    const BaseScore score(cloud_, kept_, options_, pool_);
    const double of_plane = no_choice ? 0 : score.Of(plane.base).score;
    const double noise = kAtNoise * statistics_.noise;
    const bool plane_is_right = !no_choice && of_plane <= noise * noise;
    // A one-sided sheet has no height field either; steep ground only looks like one.
    if (one_sided_ && !plane_is_right) throw std::invalid_argument(refusal);
    if (!refusal.empty()) {
      if (asked_for) throw std::invalid_argument(refusal);
      return false;
    }
    // Settling gains a few hundredths, not more.
    const bool hopeless = !no_choice && score.Of(sheet.base).score > kHopeless * of_plane;
    const bool settled =
        !hopeless && SettleParameters(sheet.base, cloud_, sheet.reached, score, pool_);
    // Over steep places a plane's cells are long: a tie goes to the sheet there.
    const double better = !plane_is_right                 ? kBetterOnRoughGround
                          : plane_.steepness > kVerySteep ? kAsGood
                                                          : kClearlyBetter;
    if (!no_choice && (hopeless || score.Of(sheet.base).score >= better * of_plane)) {
      plane.base.why += "; laid out flat, points are not predicted clearly better";
      return false;
    }
    if (settled) sheet.base.why += "; parameters settled on a coarse surface";
    return true;
  }

  const PointCloud& cloud_;
  const CloudStatistics& statistics_;
  const SurfaceFitOptions& options_;
  ThreadPool& pool_;
  std::vector<Eigen::Index> kept_;  // points that do not stand out
  Eigen::Matrix3Xd some_ = Eigen::Matrix3Xd(3, 0);
  std::optional<NeighbourIndex> own_index_;  // of those, where they are not all
  const Eigen::Matrix3Xd* good_ = nullptr;
  const NeighbourIndex* index_ = nullptr;
  double margin_ = 0;
  PlaneBase plane_;
  std::string layers_, slope_;  // of the plane, in words
  bool one_sided_ = false;      // the sheet
};

}  // namespace

BaseChoice ChooseBase(const PointCloud& cloud,
                      const NeighbourIndex& index,
                      const CloudStatistics& statistics,
                      const SurfaceFitOptions& options,
                      ThreadPool& pool) {
  return BaseChooser(cloud, index, statistics, options, pool).Choose();
}

}  // namespace batten
