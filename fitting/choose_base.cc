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
#include "batten/fitting/closed_bases.h"
#include "batten/fitting/empty_share.h"
#include "batten/fitting/plan_parts.h"
#include "batten/fitting/plane_base.h"
#include "batten/fitting/pole_kinds.h"
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
constexpr double kHopeless = 1.1;      // times the plane's score: no settling makes up for that
constexpr double kManyLengths = 0.03;  // distortion of a sheet beside which a round base may serve
constexpr double kMuchEmpty = 0.2;     // of the rectangle, the same
constexpr double kVerySteep = 75 / kDegrees;
constexpr double kAsGood = 1.01;          // a sheet's score against a plane's, on steep places
constexpr double kClearlyBetter = 0.995;  // elsewhere
constexpr double kFewLetGo = 0.005;       // of the points
constexpr double kClearlyFewer = 0.8;     // control points

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
    BaseChoice choice = Chosen();
    Close(choice.base);
    return choice;
  }

 private:
  bool plane_possible() const { return plane_.overlap <= kOverlapToRefuse; }
  bool automatic() const { return options_.base == BaseShape::kAuto; }
  bool asks_to_close() const {
    return options_.closed != Closing::kAuto && options_.closed != Closing::kNone;
  }

  struct Scored {
    BaseChoice choice;
    BaseScore::Value value;
  };

  bool plane_allowed() const { return options_.base != BaseShape::kSheet && plane_possible(); }

  BaseChoice Chosen() {
    if (!automatic() && options_.base != BaseShape::kPlane && options_.base != BaseShape::kSheet) {
      return Required(BestRound());
    }
    BaseChoice plane = OverPlane();
    if (automatic() && !asks_to_close() && plane_.overlap <= kOverlapToWarn &&
        plane_.steepness <= kGentle) {
      return plane;
    }
    std::optional<BaseChoice> sheet;
    if (options_.base == BaseShape::kPlane) {
      refusal_ = layers_ +
                 ": the points are not a height field over a plane; --base sheet lays a bent sheet "
                 "out flat, --box takes a part of the cloud";
    } else {
      sheet = OverSheet();
      if (one_sided_ && !plane_allowed()) throw std::invalid_argument(refusal_);
    }
    std::optional<Scored> round;
    if (asks_to_close() || MayBeRound(sheet)) round = BestRound();
    if (asks_to_close()) return Required(std::move(round));
    if (round && sheet && !IsBetter(ScoreOf(*sheet), round->value)) sheet.reset();
    std::optional<Scored> open = BestOpen(std::move(plane), std::move(sheet), round.has_value());
    if (open && !(round && IsBetter(round->value, open->value))) return std::move(open->choice);
    return Required(std::move(round));
  }

  BaseChoice Required(std::optional<Scored>&& found) const {
    if (!found) throw std::invalid_argument(refusal_);
    return std::move(found->choice);
  }

  // What closes cannot be laid out flat, or only with lengths that differ much; a fan, as a part of
  // a cone, lies badly in a rectangle.
  bool MayBeRound(const std::optional<BaseChoice>& sheet) const {
    if (options_.base == BaseShape::kPlane) return false;
    if (!sheet) return true;
    if (!automatic()) return false;
    const SurfaceBase& base = sheet->base;
    return distortion_ > kManyLengths ||
           EmptyShare(base.parameters, sheet->reached, base.length_u, base.length_v) > kMuchEmpty;
  }

  const BaseScore& score() {
    if (!score_) score_.emplace(cloud_, kept_, options_, pool_);
    return *score_;
  }

  BaseScore::Value ScoreOf(const BaseChoice& choice) {
    // A base that lets go of more than strays must answer for what it lets go of.
    const auto left =
        static_cast<double>(kept_.size()) - static_cast<double>(choice.reached.count());
    return left <= kFewLetGo * static_cast<double>(kept_.size())
               ? score().Of(choice.base, choice.reached)
               : score().Of(choice.base, PointMask::Constant(cloud_.size(), true));
  }

  // Of what predicts left-out points as well, the simpler.
  static bool IsBetter(const BaseScore::Value& a, const BaseScore::Value& b) {
    return a.score < kClearlyBetter * b.score ||
           (a.score <= kAsGood * b.score && a.control_points < kClearlyFewer * b.control_points);
  }

  GoodPoints good() const { return {*good_, *index_, statistics_, margin_}; }

  // The same for all points; those that stand out have no place.
  BaseChoice ForAll(ClosedBase&& closed) const {
    BaseChoice choice{std::move(closed.base), PointMask::Constant(cloud_.size(), false), {}};
    const Eigen::Matrix2Xd of_good = std::move(choice.base.parameters);
    choice.base.parameters = Eigen::Matrix2Xd::Zero(2, cloud_.size());
    for (size_t k = 0; k < kept_.size(); ++k) {
      const auto from = static_cast<Eigen::Index>(k);
      choice.base.parameters.col(kept_[k]) = of_good.col(from);
      choice.reached[kept_[k]] = closed.reached[from];
    }
    return choice;
  }

  // Of the bases that close and serve, that over which left-out points are predicted best, poles
  // told apart; none with a refusal.
  std::optional<Scored> BestRound() {
    // What is a height field, but for few layers, is no tube.
    const bool height_field = plane_allowed() && plane_.overlap <= kOverlapToWarn;
    ClosedBases closed = FindClosedBases(good(), options_, !height_field, pool_);
    if (closed.serving.empty()) {
      refusal_ += (refusal_.empty() ? "" : "; ") + closed.refusal;
      return std::nullopt;
    }
    std::optional<Scored> best;
    for (ClosedBase& one : closed.serving) {
      BaseChoice choice = ForAll(std::move(one));
      const BaseScore::Value value = ScoreOf(choice);
      if (!best || IsBetter(value, best->value)) best = {std::move(choice), value};
    }
    SurfaceBase& base = best->choice.base;
    base.poles =
        PolesByData(base, cloud_, score().sample() && best->choice.reached, best->value, pool_);
    return best;
  }

  // Directions as asked for.
  void Close(SurfaceBase& base) const {
    const Closing asked = options_.closed;
    if (asked == Closing::kAuto) return;
    const bool u = asked == Closing::kU || asked == Closing::kBoth,
               v = asked == Closing::kV || asked == Closing::kBoth;
    if ((u && !base.periodic_u) || (v && !base.periodic_v)) {
      throw std::invalid_argument("the points do not close in the direction asked for: " +
                                  base.why + "; leave the choice to them (--closed auto)");
    }
    base.periodic_u = u;
    base.periodic_v = v;
  }

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

  // The sheet laid out flat; points that stand out have no place. None with a refusal.
  std::optional<BaseChoice> OverSheet() {
    const SheetBase sheet = FlattenSheet(*good_,
                                         *index_,
                                         statistics_.spacing,
                                         statistics_.noise,
                                         margin_,
                                         {},
                                         pool_,
                                         options_.progress);
    refusal_ = sheet.refusal;
    one_sided_ = !sheet.orientation_consistent;
    distortion_ = sheet.distortion;
    if (!sheet.serves()) return std::nullopt;
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

  // The sheet, its parameters settled where that pays, or the plane; none where there is neither.
  // `scored`: its value is asked for.
  std::optional<Scored> BestOpen(BaseChoice&& plane,
                                 std::optional<BaseChoice>&& sheet,
                                 bool scored) {
    if (plane_.overlap > kOverlapToWarn) {
      plane.warnings.push_back(layers_ + ": a height field goes between the layers there");
    }
    if (!plane_allowed()) {
      if (!sheet) return std::nullopt;
      Settle(*sheet);
      const BaseScore::Value value = scored ? ScoreOf(*sheet) : BaseScore::Value{};
      return Scored{std::move(*sheet), value};
    }
    if (!sheet && !scored && !one_sided_) return Scored{std::move(plane), {}};
    const BaseScore::Value of_plane = ScoreOf(plane);
    const double noise = kAtNoise * statistics_.noise;
    const bool plane_is_right = of_plane.score <= noise * noise;
    // A one-sided sheet has no height field either; steep ground only looks like one.
    if (one_sided_ && !plane_is_right) throw std::invalid_argument(refusal_);
    if (!sheet) return Scored{std::move(plane), of_plane};
    // Settling gains a few hundredths, not more.
    if (ScoreOf(*sheet).score <= kHopeless * of_plane.score) {
      Settle(*sheet);
      // Over steep places a plane's cells are long: a tie goes to the sheet there.
      const double better = !plane_is_right                 ? kBetterOnRoughGround
                            : plane_.steepness > kVerySteep ? kAsGood
                                                            : kClearlyBetter;
      const BaseScore::Value of_sheet = ScoreOf(*sheet);
      if (of_sheet.score < better * of_plane.score ||
          (plane_is_right && IsBetter(of_sheet, of_plane))) {
        return Scored{std::move(*sheet), of_sheet};
      }
    }
    plane.base.why += "; laid out flat, points are not predicted clearly better";
    return Scored{std::move(plane), of_plane};
  }

  void Settle(BaseChoice& sheet) {
    if (SettleParameters(sheet.base, cloud_, sheet.reached, score(), pool_)) {
      sheet.base.why += "; parameters settled on a coarse surface";
    }
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
  double distortion_ = 0;       // of it
  std::string refusal_;         // of what has been tried
  std::optional<BaseScore> score_;
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
