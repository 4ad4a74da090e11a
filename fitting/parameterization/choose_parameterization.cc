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
#include "fitting/parameterization/base_comparison.h"
#include "fitting/parameterization/closed_bases.h"
#include "fitting/parameterization/connected_components.h"
#include "fitting/parameterization/open_bases.h"
#include "fitting/parameterization/pole_kinds.h"
#include "fitting/parameterization/wing_candidate.h"
#include "geometry/numeric/number_text.h"

namespace batten::internal {
namespace {

constexpr double kApartToRefuse = 0.1;      // share of the points …
constexpr double kFarApart = 4;             // … in parts whose sizes the cloud's exceeds so often
constexpr Eigen::Index kManyPerSample = 3;  // inliers for each of the sample: a first look pays

bool AsksToClose(const SurfaceFitOptions& options) {
  return options.closed != Closing::kAuto && options.closed != Closing::kNone;
}

// A sharp edge takes the place of given boundaries, and a height field has one side only.
bool MayBeWing(const SurfaceFitOptions& options, const PlaneBase& plane) {
  const bool closed = options.base == BaseShape::kAuto && plane.overlap > kOverlapToWarn;
  return (closed || options.base == BaseShape::kWing) && options.closed == Closing::kAuto &&
         SidesAreFree(options);
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

// Why no base serves, from what is said of each that was considered; `one_sided`: so the sheet is.
RefusedData NoBase(BaseShape asked, bool one_sided, const std::vector<BaseCandidate>& rows) {
  std::string why;
  for (const BaseCandidate& row : rows) {
    if (row.refused.empty() || (row.name == "plane" && rows.size() > 1)) continue;
    if (asked == BaseShape::kAuto && row.name != "sheet") continue;
    why += (why.empty() ? "" : "; ") + row.refused;
  }
  if (asked == BaseShape::kAuto && !one_sided) {
    why += std::string(why.empty() ? "" : "; ") +
           "nor are the points a sphere, a torus, a surface of revolution or a tube: one NURBS "
           "surface, a rectangle with edges that may be joined or drawn together, cannot cover "
           "them; fit them in parts";
  }
  return RefusedData(why,
                     asked == BaseShape::kPlane                ? Remedy::kFlatten
                     : asked == BaseShape::kAuto && !one_sided ? Remedy::kFitPart
                                                               : Remedy::kNone);
}

// Tries candidates one after the other and keeps the one that predicts left-out points best.
class BaseContest {
 public:
  explicit BaseContest(const BaseInput& input) : input_(input), comparison_(input) {}

  void Try(const BaseMethod& candidate) {
    const bool straightens = candidate.straightens && best_ && best_->attempt.ragged;
    if (!straightens && (decided_ || (candidate.last_resort && !IsNeeded(candidate)))) return;
    if (candidate.of_two_sheets && best_ && BestIsAtNoise()) return;
    BaseCandidate& row = Row(candidate.name);
    BaseAttempt made = MakeFor(candidate);
    if (candidate.name == "sheet") one_sided_ = made.one_sided;
    if (!made.ok()) {
      row.refused = made.failure_reason;
      return;
    }
    served_.push_back(candidate.name);
    decided_ = decided_ || made.certain || input_.options.base != BaseShape::kAuto;
    if (best_ && Acts(Rule::kHopelessBases) && comparison_.IsHopeless(made, ValueOf(*best_))) {
      row.refused = "predicts left-out points worse, by a few grids";
      return;
    }
    if (!made.complete) made = Made(candidate, std::nullopt);
    if (!made.ok()) {  // all of the points refuse what a sample did not
      row.refused = made.failure_reason;
      return;
    }
    ScoredBase scored{std::move(made), candidate.name};
    if (candidate.name == "rectangle") {
      // A map is good to a share of the sheet's width: what does not settle is no base.
      ScoredBase as_laid = scored;
      if (!comparison_.Settle(scored, best_ ? &*best_ : nullptr)) {
        row.refused = "its parameters settle on no surface of few control points";
        return;
      }
      scored.as_laid = ValueOf(as_laid);
    } else if (candidate.smooth && Acts(Rule::kSmoothedParameters)) {
      scored.as_laid = ValueOf(scored);
      comparison_.Smooth(scored);
    }
    if (best_) {
      const double own = ValueOf(scored).score, its = ValueOf(*best_).score;
      if (!comparison_.Beats(scored, *best_)) {
        row.refused = own < its
                          ? "predicts left-out points not clearly better, for its control points"
                          : "predicts left-out points no better";
        return;
      }
      Row(best_->name).refused = "predicts left-out points worse, or needs more for it";
    }
    row.refused.clear();
    best_ = std::move(scored);
  }

  // Throws RefusedData if no candidate served.
  ParameterizationChoice Result() {
    // A one-sided surface is no height field either; steep ground only looks one-sided.
    if (!best_ || (one_sided_ && !BestIsAtNoise()))
      throw NoBase(input_.options.base, one_sided_, rows_);
    BaseAttempt& taken = best_->attempt;
    if (taken.base.poles.any()) {
      const BaseScore::Value& value = ValueOf(*best_);
      const PointMask some = comparison_.score().sample() && taken.reached;
      taken.base.poles = PolesByData(taken.base, input_.cloud, some, value, input_.pool);
    }
    const bool fits_noise = taken.certain || BestIsAtNoise();
    return {std::move(taken.base),
            std::move(taken.reached),
            std::move(taken.warnings),
            std::move(rows_),
            fits_noise};
  }

 private:
  BaseCandidate& Row(const std::string& name) {
    for (BaseCandidate& row : rows_)
      if (row.name == name) return row;
    return rows_.emplace_back(BaseCandidate{name});
  }

  // Notes it in the report besides.
  const BaseScore::Value& ValueOf(ScoredBase& scored) {
    const BaseScore::Value& value = comparison_.ValueOf(scored);
    BaseCandidate& row = Row(scored.name);
    row.score = std::sqrt(value.score);
    row.control_points = value.control_points;
    return value;
  }

  bool BestIsAtNoise() { return comparison_.IsAtNoise(ValueOf(*best_)); }

  // A last resort is made where no candidate of its name served before it, and none to the noise.
  bool IsNeeded(const BaseMethod& candidate) {
    if (std::find(served_.begin(), served_.end(), candidate.name) != served_.end()) return false;
    return !best_ || best_->attempt.distorted || !BestIsAtNoise();
  }

  // Beside another, a candidate is made for a sample first where that is much cheaper.
  BaseAttempt MakeFor(const BaseMethod& candidate) {
    const auto inliers = std::ssize(input_.places());
    InlierSubset some;
    if (best_ && kManyPerSample * comparison_.score().sample().count() <= inliers) {
      const PointMask& sample = comparison_.score().sample();
      some.emplace();
      for (Eigen::Index k = 0; k < inliers; ++k)
        if (sample[input_.places()[static_cast<size_t>(k)]]) some->push_back(k);
    }
    return Made(candidate, some);
  }

  static BaseAttempt Made(const BaseMethod& candidate, const InlierSubset& some) {
    try {
      return candidate.make(some);
    } catch (const std::invalid_argument& refusal) {
      return Failure(refusal.what());
    }
  }

  const BaseInput& input_;
  BaseComparison comparison_;
  std::optional<ScoredBase> best_;
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
  const PlaneBase plane = FindPlaneBase(
      input.inliers(), input.index(), statistics.spacing, input.margin(), options.seed, pool);
  RefuseParts(input, plane);
  BaseContest contest(input);
  for (const BaseMethod& candidate : CandidatesFor(input, plane)) contest.Try(candidate);
  ParameterizationChoice choice = contest.Result();
  Close(options.closed, choice.base);
  return choice;
}

}  // namespace batten::internal
