// SPDX-License-Identifier: MIT
#include "fitting/parameterization/choose_parameterization.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "fitting/core/rules.h"
#include "fitting/flattening/sheet_base.h"
#include "fitting/parameterization/base_score.h"
#include "fitting/parameterization/closed_bases.h"
#include "fitting/parameterization/connected_components.h"
#include "fitting/parameterization/empty_area_fraction.h"
#include "fitting/parameterization/parameter_smoothing.h"
#include "fitting/parameterization/plane_base.h"
#include "fitting/parameterization/pole_kinds.h"
#include "geometry/numeric/number_text.h"

namespace batten::internal {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kOverlapToWarn = 0.02;
constexpr double kOverlapToRefuse = 0.15;
constexpr double kGentle = std::numbers::pi / 4;  // steepness up to which a plane is taken at once
constexpr double kAtNoise = 1.5;
constexpr double kApartToRefuse = 0.1;
constexpr double kHopeless = 1.1;          // times the plane's score; beyond, no smoothing helps
constexpr double kClearlyHopeless = 1.03;  // times that, if only a few grids are scored
constexpr double kManyMore = 3;            // times the control points of a plane at the noise
constexpr double kManyLengths = 0.03;      // distortion of a sheet; above, round bases are tried
constexpr double kMuchEmpty = 0.2;         // empty share of its rectangle; above, the same
constexpr double kAsGood = 1.01;          // score ratio, with clearly fewer control points
constexpr double kClearlyBetter = 0.995;  // elsewhere
constexpr double kFewLetGo = 0.005;       // share of the points without a place
constexpr double kClearlyFewer = 0.8;     // ratio of control points
constexpr const char* kFewGrids = "predicts left-out points worse, by a few grids";

// Computes the candidate bases of a cloud and chooses between them; members hold what every step
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
    plane_ =
        FindPlaneBase(*good_, *index_, statistics.spacing, margin_, {.seed = options.seed}, pool);
    layers_ =
        "seen from any side, they lie over each other in " + Percent(plane_.overlap) + " of places";
    slope_ = std::to_string(std::lround(plane_.steepness * kDegrees)) + " degrees";
  }

  ParameterizationChoice Choose() {
    RefuseParts();
    ParameterizationChoice choice = Chosen();
    Close(choice.base);
    choice.candidates = CandidatesBeside(choice.base.name);
    return choice;
  }

 private:
  bool plane_possible() const { return plane_.overlap <= kOverlapToRefuse; }
  bool automatic() const { return options_.base == BaseShape::kAuto; }
  bool asks_to_close() const {
    return options_.closed != Closing::kAuto && options_.closed != Closing::kNone;
  }

  BaseCandidate& Candidate(const std::string& name) {
    for (BaseCandidate& one : candidates_)
      if (one.name == name) return one;
    return candidates_.emplace_back(BaseCandidate{name});
  }

  const BaseScore::Value& Record(const std::string& name, const BaseScore::Value& value) {
    BaseCandidate& one = Candidate(name);
    one.score = std::sqrt(value.score);
    one.control_points = value.control_points;
    return value;
  }

  // All candidates, with the reason why the others were not taken.
  std::vector<BaseCandidate> CandidatesBeside(const std::string& taken) {
    const std::optional<double> best = Candidate(taken).score;
    for (BaseCandidate& one : candidates_) {
      if (one.name == taken) {
        one.refused.clear();
      } else if (one.refused.empty()) {
        one.refused = one.score && best && *one.score < *best
                          ? "predicts left-out points not clearly better, for its control points"
                          : "predicts left-out points no better";
      }
    }
    return candidates_;
  }

  struct Scored {
    ParameterizationChoice choice;
    BaseScore::Value value;
  };

  bool plane_allowed() const { return options_.base != BaseShape::kSheet && plane_possible(); }

  ParameterizationChoice Chosen() {
    if (!automatic() && options_.base != BaseShape::kPlane && options_.base != BaseShape::kSheet) {
      std::optional<Scored> round = BestRound();
      AddRevolutionFailure();
      return Required(std::move(round));
    }
    ParameterizationChoice plane = OverPlane();
    if (options_.base != BaseShape::kSheet)
      Candidate("plane").refused = plane_possible() ? "" : layers_;
    if (Acts(Rule::kGentlePlane) && automatic() && !asks_to_close() &&
        plane_.overlap <= kOverlapToWarn &&
        plane_.steepness <= kGentle) {
      return plane;
    }
    if (options_.base == BaseShape::kPlane) {
      failure_reason_ =
          layers_ +
          ": the points are not a height field over a plane; --base sheet lays a bent sheet "
          "out flat, --box takes a part of the cloud";
    } else {
      layout_.emplace(*good_,
                      *index_,
                      statistics_.spacing,
                      statistics_.noise,
                      margin_,
                      SheetBaseOptions{},
                      pool_,
                      options_.progress);
    }
    // If a closed base fits to the noise, the sheet needs no attempt at finer resolution.
    std::optional<Scored> round;
    bool asked_for_round = false;
    if (layout_ && !layout_->found().ok()) {
      if (automatic() && !asks_to_close()) {
        round = BestRound();
        asked_for_round = true;
      }
      if (!round || !IsAtNoise(round->value)) layout_->LookCloser();
    }
    std::optional<ParameterizationChoice> sheet = layout_ ? OverSheet() : std::nullopt;
    if (one_sided_ && !plane_allowed() && !(round && IsAtNoise(round->value)))
      throw std::invalid_argument(failure_reason_);
    if (!asks_to_close() && !MayBeRound(sheet)) {
      round.reset();
    } else if (!asked_for_round) {
      // If there is a sheet and the plane serves, closed bases must be better than the plane.
      round = BestRound(sheet && plane_allowed() && !asks_to_close() ? &plane : nullptr);
    }
    AddRevolutionFailure();
    if (asks_to_close()) return Required(std::move(round));
    if (round && sheet && !IsBetter(SheetScore(*sheet), round->value)) sheet.reset();
    std::optional<Scored> open = BestOpen(std::move(plane), std::move(sheet), round.has_value());
    if (open && !(round && IsBetter(round->value, open->value))) return std::move(open->choice);
    return Required(std::move(round));
  }

  ParameterizationChoice Required(std::optional<Scored>&& found) const {
    if (!found) throw std::invalid_argument(failure_reason_);
    return std::move(found->choice);
  }

  void AddRevolutionFailure() {
    if (!revolution_failure_.empty())
      failure_reason_ += (failure_reason_.empty() ? "" : "; ") + revolution_failure_;
  }

  bool IsAtNoise(const BaseScore::Value& value) const {
    return value.score <= std::pow(kAtNoise * statistics_.noise, 2);
  }

  // Whether closed bases are tried: a closed shape cannot be flattened, or only with much
  // distortion; a fan, as a part of a cone, leaves much of its rectangle empty.
  bool MayBeRound(const std::optional<ParameterizationChoice>& sheet) const {
    if (options_.base == BaseShape::kPlane) return false;
    if (!sheet) return true;
    if (!automatic()) return false;
    if (!Acts(Rule::kRoundGate)) return true;
    const Parameterization& base = sheet->base;
    return distortion_ > kManyLengths ||
           EmptyAreaFraction(base.parameters, sheet->reached, base.length_u, base.length_v) >
               kMuchEmpty;
  }

  const BaseScore& score() {
    if (!score_) score_.emplace(cloud_, kept_, options_, pool_);
    return *score_;
  }

  // Scores a base; if it leaves more points than outliers without a place, these count too.
  BaseScore::Value ScoreOf(const ParameterizationChoice& choice) {
    return Record(choice.base.name, score().Of(choice.base, CountedOf(choice, std::ssize(kept_))));
  }

  // Whether base a predicts left-out points clearly better, or as well with clearly fewer control
  // points.
  static bool IsBetter(const BaseScore::Value& a, const BaseScore::Value& b) {
    return a.score < kClearlyBetter * b.score ||
           (a.score <= kAsGood * b.score && a.control_points < kClearlyFewer * b.control_points);
  }

  GoodPoints good() const {
    return {*good_, *index_, statistics_, margin_, layout_ ? &layout_->nodes() : nullptr};
  }

  // Extends a closed base from the inliers to all points; outliers have no place.
  ParameterizationChoice ForAll(ClosedBase&& closed,
                                const std::vector<Eigen::Index>& places) const {
    ParameterizationChoice choice{
        std::move(closed.base), PointMask::Constant(cloud_.size(), false), {}};
    const Eigen::Matrix2Xd of_some = std::move(choice.base.parameters);
    choice.base.parameters = Eigen::Matrix2Xd::Zero(2, cloud_.size());
    for (size_t k = 0; k < places.size(); ++k) {
      const auto from = static_cast<Eigen::Index>(k);
      choice.base.parameters.col(places[k]) = of_some.col(from);
      choice.reached[places[k]] = closed.reached[from];
    }
    return choice;
  }

  // Returns the points that scores are computed from.
  std::vector<Eigen::Index> Sampled() {
    std::vector<Eigen::Index> sampled;
    for (const Eigen::Index k : kept_)
      if (score().sample()[k]) sampled.push_back(k);
    return sampled;
  }

  bool IsHopelessBeside(const ParameterizationChoice& plane,
                        const ParameterizationChoice& round,
                        Eigen::Index points) {
    if (!Acts(Rule::kHopelessBases)) return false;
    const BaseScore::Value& of_plane = PlaneScore(plane);
    return IsAtNoise(of_plane) &&
           AtMostBeside(round, points, of_plane) > kClearlyHopeless * kHopeless * of_plane.score;
  }

  // Whether closed bases cannot compete with a plane at the noise, judged by the sampled points
  // alone: if these are a small part of the cloud, this is fast.
  bool AreHopelessBeside(const ParameterizationChoice& plane) {
    constexpr Eigen::Index kManyMorePoints = 3;
    if (!Acts(Rule::kHopelessBases)) return false;
    const std::vector<Eigen::Index> sampled = Sampled();
    if (kManyMorePoints * std::ssize(sampled) > std::ssize(kept_)) return false;
    const Eigen::Matrix3Xd some = cloud_.points()(Eigen::all, sampled);
    const GoodPoints part{some, *index_, statistics_, margin_, &layout_->nodes()};
    ClosedBases closed = FindClosedBases(part, options_, false, pool_);
    return !closed.serving.empty() &&
           std::all_of(closed.serving.begin(), closed.serving.end(), [&](ClosedBase& one) {
             return IsHopelessBeside(plane, ForAll(std::move(one), sampled), std::ssize(sampled));
           });
  }

  // Returns the closed base that predicts left-out points best, with its poles classified; none if
  // none serves, or if none can compete with a plane at the noise.
  std::optional<Scored> BestRound(const ParameterizationChoice* plane = nullptr) {
    // A height field, but for few layers, is no tube.
    const bool height_field = plane_allowed() && plane_.overlap <= kOverlapToWarn;
    if (plane != nullptr && height_field && IsAtNoise(PlaneScore(*plane)) &&
        AreHopelessBeside(*plane)) {
      Candidate("closed").refused = kFewGrids;
      return std::nullopt;
    }
    ClosedBases closed = FindClosedBases(good(), options_, !height_field, pool_);
    if (closed.serving.empty()) {
      revolution_failure_ = closed.failure_reason;
      Candidate("closed").refused = closed.failure_reason;
      return std::nullopt;
    }
    std::optional<Scored> best;
    for (ClosedBase& one : closed.serving) {
      ParameterizationChoice choice = ForAll(std::move(one), kept_);
      if (plane != nullptr && IsHopelessBeside(*plane, choice, std::ssize(kept_))) {
        Candidate(choice.base.name).refused = kFewGrids;
        continue;
      }
      const BaseScore::Value value = ScoreOf(choice);
      if (!best || IsBetter(value, best->value)) best = {std::move(choice), value};
    }
    if (!best) return std::nullopt;
    Parameterization& base = best->choice.base;
    base.poles =
        PolesByData(base, cloud_, score().sample() && best->choice.reached, best->value, pool_);
    return best;
  }

  // Makes directions periodic as the options ask.
  void Close(Parameterization& base) const {
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
    Eigen::Matrix2Xd plan(2, good_->cols());
    for (Eigen::Index k = 0; k < plan.cols(); ++k)
      plan.col(k) = plane_.axes.leftCols<2>().transpose() * (good_->col(k) - plane_.origin);
    const double apart = DetachedFraction(plan, options_.seed);
    if (apart <= kApartToRefuse) return;
    throw std::invalid_argument(Percent(apart) +
                                " of the points lie far apart from the others: a surface is one "
                                "piece; fit one part of the cloud at a time (--box, --where)");
  }

  ParameterizationChoice OverPlane() const {
    Parameterization base;
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

  // Flattens the sheet; outliers have no place. None if the flattening fails. If there are many
  // points and another base to be tried, only the sample gets places.
  std::optional<ParameterizationChoice> OverSheet() {
    const SheetBase& found = layout_->found();
    failure_reason_ = found.failure_reason;
    Candidate("sheet").refused = found.failure_reason;
    one_sided_ = !found.orientation_consistent;
    distortion_ = found.distortion;
    if (!found.ok()) return std::nullopt;
    sheet_sampled_ = plane_allowed() && score().sample().count() < good_->cols();
    ParameterizationChoice laid;
    laid.base.name = "sheet";
    laid.base.shape = "a smooth sheet";
    Lay(sheet_sampled_, laid);
    laid.base.why = options_.base == BaseShape::kSheet ? "asked for"
                    : plane_.overlap > kOverlapToWarn
                        ? layers_
                        : "seen from any side, the points are inclined up to " + slope_ +
                              ", and laid out flat they are predicted better";
    return laid;
  }

  // Assigns parameters on the sheet to all inliers, or to those of the sample.
  void Lay(bool sampled, ParameterizationChoice& laid) {
    std::vector<Eigen::Index> which;  // of the good points
    for (size_t k = 0; sampled && k < kept_.size(); ++k)
      if (score().sample()[kept_[k]]) which.push_back(static_cast<Eigen::Index>(k));
    const SheetBase sheet =
        sampled ? layout_->Over((*good_)(Eigen::all, which)) : layout_->Over(*good_);
    laid.base.length_u = sheet.length_u;
    laid.base.length_v = sheet.length_v;
    laid.reached = PointMask::Constant(cloud_.size(), false);
    laid.base.parameters = Eigen::Matrix2Xd::Zero(2, cloud_.size());
    for (Eigen::Index from = 0; from < sheet.parameters.cols(); ++from) {
      const Eigen::Index to = kept_[sampled ? which[from] : from];
      laid.base.parameters.col(to) = sheet.parameters.col(from);
      laid.reached[to] = sheet.reached[from];
    }
  }

  // All points that the score looks at must count where too many were let go.
  bool LetsGo(const ParameterizationChoice& choice, Eigen::Index of) const {
    const auto all = static_cast<double>(of);
    return all - static_cast<double>(choice.reached.count()) > kFewLetGo * all;
  }

  PointMask CountedOf(const ParameterizationChoice& choice, Eigen::Index of) const {
    return LetsGo(choice, of) ? PointMask::Constant(cloud_.size(), true).eval() : choice.reached;
  }

  Eigen::Index PointsOfSheet() {
    return sheet_sampled_ ? score().sample().count() : std::ssize(kept_);
  }

  // Returns the sheet's score, computed once for each set of parameters.
  const BaseScore::Value& SheetScore(const ParameterizationChoice& sheet) {
    if (!sheet_score_) sheet_score_ = score().Of(sheet.base, CountedOf(sheet, PointsOfSheet()));
    return Record("sheet", *sheet_score_);
  }

  // Returns the sheet, with smoothed parameters if they are better, or the plane; none if there is
  // neither. `scored`: its score is needed.
  std::optional<Scored> BestOpen(ParameterizationChoice&& plane,
                                 std::optional<ParameterizationChoice>&& sheet,
                                 bool scored) {
    if (plane_.overlap > kOverlapToWarn) {
      plane.warnings.push_back(layers_ + ": a height field goes between the layers there");
    }
    if (!plane_allowed()) {
      if (!sheet) return std::nullopt;
      Settle(*sheet);
      const BaseScore::Value value = scored ? SheetScore(*sheet) : BaseScore::Value{};
      return Scored{std::move(*sheet), value};
    }
    if (!sheet && !scored && !one_sided_) return Scored{std::move(plane), {}};
    const BaseScore::Value of_plane = PlaneScore(plane);
    const bool plane_is_right = IsAtNoise(of_plane);
    // A one-sided sheet is no height field either; steep ground only looks one-sided.
    if (one_sided_ && !plane_is_right) throw std::invalid_argument(failure_reason_);
    if (!sheet) return Scored{std::move(plane), of_plane};
    // Smoothing the parameters improves the score by a few hundredths at most.
    if (!IsHopeless(*sheet, of_plane)) {
      if (sheet_sampled_) Lay(sheet_sampled_ = false, *sheet);
      Settle(*sheet);
      const BaseScore::Value of_sheet = SheetScore(*sheet);
      if (IsBetter(of_sheet, of_plane)) return Scored{std::move(*sheet), of_sheet};
    }
    plane.base.why += "; laid out flat, points are not predicted clearly better";
    return Scored{std::move(plane), of_plane};
  }

  // Returns the plane's score, computed once.
  const BaseScore::Value& PlaneScore(const ParameterizationChoice& plane) {
    if (!plane_score_) plane_score_ = ScoreOf(plane);
    return *plane_score_;
  }

  // Estimates an upper bound of a base's score over so many points. If the plane fits to the noise,
  // no base with many more control points can win, and grids are limited to that.
  double AtMostBeside(const ParameterizationChoice& choice,
                      Eigen::Index points,
                      const BaseScore::Value& of_plane) {
    const double control_points =
        IsAtNoise(of_plane) ? kManyMore * of_plane.control_points : HUGE_VAL;
    return score().AtMost(choice.base, CountedOf(choice, points), of_plane, control_points).score;
  }

  // Whether the sheet cannot compete with the plane, by a few grids if that suffices.
  bool IsHopeless(const ParameterizationChoice& sheet, const BaseScore::Value& of_plane) {
    if (!Acts(Rule::kHopelessBases)) return false;
    const double most = kHopeless * of_plane.score;
    if (!sheet_score_) {
      const double at_most = AtMostBeside(sheet, PointsOfSheet(), of_plane);
      if (at_most <= most) return false;
      if (at_most > kClearlyHopeless * most) {
        Candidate("sheet").refused = kFewGrids;
        return true;
      }
    }
    return SheetScore(sheet).score > most;
  }

  void Settle(ParameterizationChoice& sheet) {
    if (!Acts(Rule::kSmoothedParameters)) return;
    const BaseScore::Value before = score().Of(sheet.base, sheet.reached);
    const Settled settled =
        SmoothParameters(sheet.base, cloud_, sheet.reached, score(), before, pool_);
    if (settled.any) sheet.base.why += "; parameters settled on a coarse surface";
    sheet_score_.reset();
    if (!LetsGo(sheet, std::ssize(kept_))) sheet_score_ = Record("sheet", settled.value);
  }

  const PointCloud& cloud_;
  const CloudStatistics& statistics_;
  const SurfaceFitOptions& options_;
  ThreadPool& pool_;
  std::vector<Eigen::Index> kept_;  // indices of the inliers
  Eigen::Matrix3Xd some_ = Eigen::Matrix3Xd(3, 0);
  std::optional<NeighbourIndex> own_index_;  // index of the inliers, if they are not all points
  const Eigen::Matrix3Xd* good_ = nullptr;
  const NeighbourIndex* index_ = nullptr;
  double margin_ = 0;
  PlaneBase plane_;
  std::string layers_, slope_;      // of the plane, in words
  bool one_sided_ = false;          // the sheet
  double distortion_ = 0;           // of it
  std::string failure_reason_;      // of what has been tried
  std::string revolution_failure_;  // of the shapes that close
  std::optional<SheetLayout> layout_;
  bool sheet_sampled_ = false;  // only points of the sample have places on the sheet
  std::optional<BaseScore::Value> sheet_score_, plane_score_;
  std::optional<BaseScore> score_;
  std::vector<BaseCandidate> candidates_;
};

}  // namespace

ParameterizationChoice ChooseBase(const PointCloud& cloud,
                                  const NeighbourIndex& index,
                                  const CloudStatistics& statistics,
                                  const SurfaceFitOptions& options,
                                  ThreadPool& pool) {
  return BaseChooser(cloud, index, statistics, options, pool).Choose();
}

}  // namespace batten::internal
