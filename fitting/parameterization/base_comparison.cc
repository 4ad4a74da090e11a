// SPDX-License-Identifier: MIT
#include "fitting/parameterization/base_comparison.h"

#include <cmath>

#include "fitting/core/shared_constants.h"
#include "fitting/parameterization/parameter_settling.h"
#include "fitting/parameterization/parameter_smoothing.h"

namespace batten::internal {
namespace {

constexpr double kHopeless = 1.13;        // ratio of scores by a few grids
constexpr double kManyMore = 3;           // ratio of control points
constexpr double kAsGood = 1.01;          // score ratio, with clearly fewer control points
constexpr double kClearlyBetter = 0.995;  // elsewhere
// Parameters that settled with a net have cost some of the freedom of the noise, too: errors
// are 1.35 times those of given ones, as if control points were 1.8 times as many. [measured:
// kind_fitting]
constexpr double kFarFewer = 0.6;
constexpr double kFirm = 25;         // points to a control point
constexpr double kFewLetGo = 0.005;  // share of the points without a place

// Whether base a predicts left-out points clearly better, or as well with clearly fewer control
// points.
bool IsBetter(const BaseScore::Value& a, const BaseScore::Value& b) {
  return a.score < kClearlyBetter * b.score ||
         (a.score <= kAsGood * b.score && a.control_points < kClearlyFewer * b.control_points);
}

}  // namespace

const BaseScore& BaseComparison::score() {
  if (!score_) score_.emplace(input_.cloud, input_.places(), input_.options, input_.pool);
  return *score_;
}

// The points that count: all, where the base leaves more than outliers without a place.
PointMask BaseComparison::CountedOf(const BaseAttempt& made) {
  const auto all =
      static_cast<double>(made.complete ? std::ssize(input_.places()) : score().sample().count());
  const bool lets_go = all - static_cast<double>(made.reached.count()) > kFewLetGo * all;
  return lets_go ? PointMask::Constant(input_.cloud.size(), true).eval() : made.reached;
}

const BaseScore::Value& BaseComparison::ValueOf(ScoredBase& scored) {
  if (!scored.value) scored.value = score().Of(scored.attempt.base, CountedOf(scored.attempt));
  return *scored.value;
}

bool BaseComparison::IsAtNoise(const BaseScore::Value& value) const {
  return value.score <= std::pow(kAtNoise * input_.statistics.noise, 2);
}

bool BaseComparison::IsHopeless(const BaseAttempt& made, const BaseScore::Value& best) {
  return IsAtNoise(best) &&
         score().AtMost(made.base, CountedOf(made), best, kManyMore * best.control_points).score >
             kHopeless * best.score;
}

bool BaseComparison::Beats(const ScoredBase& one, const ScoredBase& best) {
  if (best.as_laid && !one.as_laid && !one.attempt.distorted)
    return !IsBetter(*best.as_laid, *one.value);
  // So few control points follow neither layers in turn nor noise that neighbours share.
  const bool simpler = one.value->control_points < kFarFewer * best.value->control_points &&
                       kFirm * one.value->control_points < double(score().sample().count());
  if (best.attempt.certain) return simpler && one.value->score <= kAsGood * best.value->score;
  if (one.as_laid && !simpler && !best.attempt.distorted && !IsBetter(*one.as_laid, *best.value))
    return false;
  return IsBetter(*one.value, *best.value);
}

bool BaseComparison::Settle(ScoredBase& scored, ScoredBase* best) {
  std::optional<BaseScore::Value> rival;
  if (best) {
    rival = ValueOf(*best);
    rival->score *= kHopeless;
    if (best->attempt.certain) {  // then it has to be simpler, however near it is
      rival->score = 0;
      rival->control_points = static_cast<int>(kFarFewer * rival->control_points);
    }
  }
  BaseAttempt& made = scored.attempt;
  if (!SettleParameters(made.base,
                        input_.cloud,
                        made.reached,
                        score().sample(),
                        input_.margin(),
                        rival ? &*rival : nullptr,
                        input_.pool))
    return false;
  made.base.why += "; parameters settled on a surface of few control points";
  scored.value.reset();
  return true;
}

void BaseComparison::Smooth(ScoredBase& scored) {
  BaseAttempt& made = scored.attempt;
  const bool all_reached = (CountedOf(made) == made.reached).all();
  const BaseScore::Value before =
      all_reached ? *scored.as_laid : score().Of(made.base, made.reached);
  const std::optional<BaseScore::Value> smoothed =
      SmoothParameters(made.base, input_.cloud, made.reached, score(), before, input_.pool);
  if (smoothed) made.base.why += "; parameters settled on a coarse surface";
  scored.value.reset();
  if (all_reached) scored.value = smoothed.value_or(before);
}

}  // namespace batten::internal
