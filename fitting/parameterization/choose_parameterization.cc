// SPDX-License-Identifier: MIT
#include "fitting/parameterization/choose_parameterization.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/refused_data.h"
#include "fitting/cloud/connected_points.h"
#include "fitting/core/rules.h"
#include "fitting/parameterization/base_attempt.h"
#include "fitting/parameterization/base_score.h"
#include "fitting/parameterization/closed_bases.h"
#include "fitting/parameterization/connected_components.h"
#include "fitting/parameterization/open_bases.h"
#include "fitting/parameterization/parameter_settling.h"
#include "fitting/parameterization/parameter_smoothing.h"
#include "fitting/parameterization/pole_kinds.h"
#include "fitting/parameterization/wing_candidate.h"
#include "geometry/numeric/number_text.h"

namespace batten::internal {
namespace {

constexpr double kAtNoise = 1.5;          // times the noise
constexpr double kApartToRefuse = 0.1;    // share of the points …
constexpr double kFarApart = 4;           // … in parts whose sizes the cloud's exceeds so often
constexpr double kHopeless = 1.13;        // ratio of scores by a few grids
constexpr double kManyMore = 3;           // ratio of control points
constexpr double kAsGood = 1.01;          // score ratio, with clearly fewer control points
constexpr double kClearlyBetter = 0.995;  // elsewhere
constexpr double kClearlyFewer = 0.8;     // ratio of control points
// Parameters that settled with a net have cost some of the freedom of the noise, too: errors
// are 1.35 times those of given ones, as if control points were 1.8 times as many. [measured:
// kind_fitting]
constexpr double kFarFewer = 0.6;
constexpr double kFirm = 25;                // points to a control point
constexpr double kFewLetGo = 0.005;         // share of the points without a place
constexpr Eigen::Index kManyPerSample = 3;  // inliers for each of the sample: a first look pays

bool AsksToClose(const SurfaceFitOptions& options) {
  return options.closed != Closing::kAuto && options.closed != Closing::kNone;
}

// A sharp edge takes the place of given boundaries, and a height field has one side only.
bool MayBeWing(const SurfaceFitOptions& options, const PlaneBase& plane) {
  const bool closed = options.base == BaseShape::kAuto && plane.overlap > kOverlapToWarn;
  return (closed || options.base == BaseShape::kWing) && options.closed == Closing::kAuto &&
         options.boundary.empty() && !options.meet && !options.domain && !options.symmetric;
}

// The candidates in the order they are tried: the simplest first.
std::vector<BaseMethod> CandidatesFor(const BaseInput& input, const PlaneBase& plane) {
  const BaseShape asked = input.options.base;
  const auto flattening = std::make_shared<SheetFlattening>(input);
  std::vector<BaseMethod> open, last;
  if (asked == BaseShape::kAuto || asked == BaseShape::kPlane)
    open.push_back(PlaneCandidate(input, plane));
  if (asked == BaseShape::kAuto || asked == BaseShape::kSheet) {
    std::vector<BaseMethod> sheets = SheetCandidates(input, plane, flattening);
    open.push_back(std::move(sheets[0]));
    open.push_back(std::move(sheets[1]));
    open.push_back(RectangleCandidate(input));
    last.push_back(std::move(sheets[2]));
  }
  // A height field, but for few layers, is no tube.
  const bool tubes = asked == BaseShape::kSheet || plane.overlap > kOverlapToWarn;
  std::vector<BaseMethod> closed = ClosedCandidates(input, tubes, flattening);
  if (asked == BaseShape::kSheet) std::swap(closed, last);  // a sheet at any resolution is simpler
  std::vector<BaseMethod> all;
  const auto add = [&](std::vector<BaseMethod>& some) {
    std::move(some.begin(), some.end(), std::back_inserter(all));
  };
  if (!AsksToClose(input.options)) add(open);
  add(closed);
  if (!AsksToClose(input.options)) add(last);
  if (MayBeWing(input.options, plane)) all.push_back(WingCandidate(input));
  return all;
}

// Tries candidates one after the other and keeps the one that predicts left-out points best.
class BaseContest {
 public:
  explicit BaseContest(const BaseInput& input) : input_(input) {}

  void Try(const BaseMethod& candidate) {
    const bool straightens = candidate.straightens && best_ && best_->attempt.ragged;
    if (!straightens && (decided_ || (candidate.last_resort && !IsNeeded(candidate)))) return;
    if (candidate.of_two_sheets && best_ && IsAtNoise(ScoreOf(*best_))) return;
    BaseCandidate& row = Row(candidate.name);
    BaseAttempt made = MakeFor(candidate);
    if (candidate.name == "sheet") one_sided_ = made.one_sided;
    if (!made.ok()) {
      row.refused = made.failure_reason;
      return;
    }
    served_.push_back(candidate.name);
    decided_ = decided_ || made.certain || input_.options.base != BaseShape::kAuto;
    if (best_ && Acts(Rule::kHopelessBases) && IsHopeless(made)) {
      row.refused = "predicts left-out points worse, by a few grids";
      return;
    }
    if (!made.complete) made = Made(candidate, std::nullopt);
    if (!made.ok()) {  // all of the points refuse what a sample did not
      row.refused = made.failure_reason;
      return;
    }
    Scored scored{std::move(made), candidate.name, std::nullopt};
    if (candidate.name == "rectangle") {
      // A map is good to a share of the sheet's width: what does not settle is no base.
      if (!Settle(scored)) {
        row.refused = "its parameters settle on no surface of few control points";
        return;
      }
    } else if (candidate.smooth && Acts(Rule::kSmoothedParameters)) {
      Smooth(scored);
    }
    if (best_ && !BeatsBest(scored)) {
      row.refused = ScoreOf(scored).score < ScoreOf(*best_).score
                        ? "predicts left-out points not clearly better, for its control points"
                        : "predicts left-out points no better";
      return;
    }
    if (best_) Row(best_->name).refused = "predicts left-out points worse, or needs more for it";
    row.refused.clear();
    best_ = std::move(scored);
  }

  // Throws std::invalid_argument if no candidate served.
  ParameterizationChoice Result() {
    // A one-sided surface is no height field either; steep ground only looks one-sided.
    if (!best_ || (one_sided_ && !IsAtNoise(ScoreOf(*best_))))
      throw RefusedData(WhyNone(), WhatHelps());
    BaseAttempt& taken = best_->attempt;
    if (taken.base.poles.any()) {
      const BaseScore::Value& value = ScoreOf(*best_);
      taken.base.poles = PolesByData(
          taken.base, input_.cloud, score().sample() && taken.reached, value, input_.pool);
    }
    const bool fits_noise = taken.certain || IsAtNoise(ScoreOf(*best_));
    return {std::move(taken.base),
            std::move(taken.reached),
            std::move(taken.warnings),
            std::move(rows_),
            fits_noise};
  }

 private:
  struct Scored {
    BaseAttempt attempt;
    std::string name;
    std::optional<BaseScore::Value> value;                   // computed when first needed
    std::optional<BaseScore::Value> as_laid = std::nullopt;  // before parameters were smoothed
  };

  BaseCandidate& Row(const std::string& name) {
    for (BaseCandidate& row : rows_)
      if (row.name == name) return row;
    return rows_.emplace_back(BaseCandidate{name});
  }

  // A last resort is made where no candidate of its name served before it, and none to the noise.
  bool IsNeeded(const BaseMethod& candidate) {
    if (std::find(served_.begin(), served_.end(), candidate.name) != served_.end()) return false;
    return !best_ || best_->attempt.distorted || !IsAtNoise(ScoreOf(*best_));
  }

  // Beside another, a candidate is made for a sample first where that is much cheaper.
  BaseAttempt MakeFor(const BaseMethod& candidate) {
    const auto inliers = std::ssize(input_.places());
    InlierSubset sample;
    if (best_ && kManyPerSample * score().sample().count() <= inliers) {
      sample.emplace();
      for (Eigen::Index k = 0; k < inliers; ++k)
        if (score().sample()[input_.places()[static_cast<size_t>(k)]]) sample->push_back(k);
    }
    return Made(candidate, sample);
  }

  static BaseAttempt Made(const BaseMethod& candidate, const InlierSubset& sample) {
    try {
      return candidate.make(sample);
    } catch (const std::invalid_argument& refusal) {
      return Failure(refusal.what());
    }
  }

  const BaseScore& score() {
    if (!score_) score_.emplace(input_.cloud, input_.places(), input_.options, input_.pool);
    return *score_;
  }

  bool IsAtNoise(const BaseScore::Value& value) const {
    return value.score <= std::pow(kAtNoise * input_.statistics.noise, 2);
  }

  // Whether base a predicts left-out points clearly better, or as well with clearly fewer control
  // points.
  static bool IsBetter(const BaseScore::Value& a, const BaseScore::Value& b) {
    return a.score < kClearlyBetter * b.score ||
           (a.score <= kAsGood * b.score && a.control_points < kClearlyFewer * b.control_points);
  }

  // The points that count: all, where the base leaves more than outliers without a place.
  PointMask CountedOf(const BaseAttempt& made) {
    const auto all =
        static_cast<double>(made.complete ? std::ssize(input_.places()) : score().sample().count());
    const bool lets_go = all - static_cast<double>(made.reached.count()) > kFewLetGo * all;
    return lets_go ? PointMask::Constant(input_.cloud.size(), true).eval() : made.reached;
  }

  const BaseScore::Value& ScoreOf(Scored& scored) {
    if (!scored.value) {
      scored.value = score().Of(scored.attempt.base, CountedOf(scored.attempt));
    }
    BaseCandidate& row = Row(scored.name);
    row.score = std::sqrt(scored.value->score);
    row.control_points = scored.value->control_points;
    return *scored.value;
  }

  // Whether the best base fits to the noise, and a few grids show that another cannot compete: none
  // with many more control points can, and grids are limited to that.
  bool IsHopeless(const BaseAttempt& made) {
    const BaseScore::Value best = ScoreOf(*best_);
    return IsAtNoise(best) &&
           score().AtMost(made.base, CountedOf(made), best, kManyMore * best.control_points).score >
               kHopeless * best.score;
  }

  // Smoothed parameters can follow two layers in turn: beside a base that needs no smoothing, a
  // sheet is judged as it was laid out, and has to be clearly better.
  bool BeatsBest(Scored& scored) {
    const BaseScore::Value value = ScoreOf(scored), best = ScoreOf(*best_);
    if (best_->as_laid && !scored.as_laid && !scored.attempt.distorted)
      return !IsBetter(*best_->as_laid, value);
    // So few control points follow neither layers in turn nor noise that neighbours share.
    const bool simpler = value.control_points < kFarFewer * best.control_points &&
                         kFirm * value.control_points < double(score().sample().count());
    if (best_->attempt.certain) return simpler && value.score <= kAsGood * best.score;
    if (scored.as_laid && !simpler && !best_->attempt.distorted && !IsBetter(*scored.as_laid, best))
      return false;
    return IsBetter(value, best);
  }

  bool Settle(Scored& scored) {
    BaseAttempt& made = scored.attempt;
    scored.as_laid = ScoreOf(scored);
    if (!SettleParameters(
            made.base, input_.cloud, made.reached, score().sample(), input_.margin(), input_.pool))
      return false;
    made.base.why += "; parameters settled on a surface of few control points";
    scored.value.reset();
    return true;
  }

  void Smooth(Scored& scored) {
    BaseAttempt& made = scored.attempt;
    const bool all_reached = (CountedOf(made) == made.reached).all();
    scored.as_laid = ScoreOf(scored);
    const BaseScore::Value before =
        all_reached ? *scored.as_laid : score().Of(made.base, made.reached);
    const Settled settled =
        SmoothParameters(made.base, input_.cloud, made.reached, score(), before, input_.pool);
    if (settled.any) made.base.why += "; parameters settled on a coarse surface";
    scored.value.reset();
    if (all_reached) scored.value = settled.value;
  }

  std::string WhyNone() {
    std::string why;
    for (const BaseCandidate& row : rows_) {
      if (row.refused.empty() || (row.name == "plane" && rows_.size() > 1)) continue;
      if (input_.options.base == BaseShape::kAuto && row.name != "sheet") continue;
      why += (why.empty() ? "" : "; ") + row.refused;
    }
    if (input_.options.base != BaseShape::kAuto || one_sided_) return why;
    return (why.empty() ? "" : why + "; ") +
           "nor are the points a sphere, a torus, a surface of revolution or a tube: one NURBS "
           "surface, a rectangle with edges that may be joined or drawn together, cannot cover "
           "them; fit them in parts";
  }

  Remedy WhatHelps() const {
    return input_.options.base == BaseShape::kPlane                 ? Remedy::kFlatten
           : input_.options.base == BaseShape::kAuto && !one_sided_ ? Remedy::kFitPart
                                                                    : Remedy::kNone;
  }

  const BaseInput& input_;
  std::optional<BaseScore> score_;
  std::optional<Scored> best_;
  std::vector<BaseCandidate> rows_;  // for the report
  std::vector<std::string> served_;  // candidates that are none of the failures
  bool decided_ = false;             // no further candidate can be better
  bool one_sided_ = false;           // the surface, by its flattening
};

// Refuses parts that lie much farther from one another than they are wide: a surface of both is
// empty nearly everywhere. Nearer ones get an outline each.
void RefuseParts(const BaseInput& input, const PlaneBase& plane) {
  const Eigen::Matrix3Xd points = input.inliers();
  const double apart = DetachedFraction(plane.ToFrame(points).topRows<2>(), input.options.seed);
  if (apart <= kApartToRefuse) return;
  std::vector<Eigen::AlignedBox3d> parts(static_cast<size_t>(points.cols()));
  Eigen::AlignedBox3d whole;
  const std::vector<Eigen::Index> roots = ConnectedPoints(points, input.index(), input.pool);
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    whole.extend(points.col(k));
    parts[static_cast<size_t>(roots[static_cast<size_t>(k)])].extend(points.col(k));
  }
  double squares = 0;
  for (const Eigen::AlignedBox3d& part : parts)
    if (!part.isEmpty()) squares += part.diagonal().squaredNorm();
  if (whole.diagonal().squaredNorm() <= kFarApart * kFarApart * squares) return;
  throw RefusedData(Percent(apart) +
                        " of the points lie far apart from the others: a surface is one piece; "
                        "fit one part of the cloud at a time",
                    Remedy::kFitPart);
}

// Makes directions periodic as the options ask.
void Close(Closing asked, Parameterization& base) {
  if (asked == Closing::kAuto) return;
  const bool u = asked == Closing::kU || asked == Closing::kBoth,
             v = asked == Closing::kV || asked == Closing::kBoth;
  if ((u && !base.periodic_u) || (v && !base.periodic_v)) {
    throw RefusedData("the points do not close in the direction asked for: " + base.why +
                          "; leave the choice to them",
                      Remedy::kClosingByData);
  }
  base.periodic_u = u;
  base.periodic_v = v;
}

}  // namespace

ParameterizationChoice ChooseBase(const PointCloud& cloud,
                                  const NeighbourIndex& index,
                                  const CloudStatistics& statistics,
                                  const SurfaceFitOptions& options,
                                  ThreadPool& pool) {
  const BaseInput input(cloud, index, statistics, options, pool);
  const PlaneBase plane = FindPlaneBase(input.inliers(),
                                        input.index(),
                                        statistics.spacing,
                                        input.margin(),
                                        {.seed = options.seed},
                                        pool);
  RefuseParts(input, plane);
  BaseContest contest(input);
  for (const BaseMethod& candidate : CandidatesFor(input, plane)) contest.Try(candidate);
  ParameterizationChoice choice = contest.Result();
  Close(options.closed, choice.base);
  return choice;
}

}  // namespace batten::internal
