// SPDX-License-Identifier: MIT
// Which of two bases predicts points left out better, and what is done to parameters before.
#pragma once

#include <optional>
#include <string>

#include "fitting/parameterization/base_attempt.h"
#include "fitting/parameterization/base_score.h"

namespace batten::internal {

struct ScoredBase {
  BaseAttempt attempt;
  std::string name;
  std::optional<BaseScore::Value> value = std::nullopt;    // computed when first needed
  std::optional<BaseScore::Value> as_laid = std::nullopt;  // before parameters were moved
};

// Bases of one cloud. Keeps a reference.
class BaseComparison {
 public:
  explicit BaseComparison(const BaseInput& input) : input_(input) {}

  // Made when first asked for.
  const BaseScore& score();
  const BaseScore::Value& ValueOf(ScoredBase& scored);

  bool IsAtNoise(const BaseScore::Value& value) const;

  // Whether the best fits to the noise, and a few grids show that another cannot compete: none with
  // many more control points can, and grids are limited to that.
  bool IsHopeless(const BaseAttempt& made, const BaseScore::Value& best);

  // Of bases with values. Smoothed parameters can follow two layers in turn: beside a base that
  // needs no smoothing, a sheet is judged as it was laid out, and has to be clearly better.
  bool Beats(const ScoredBase& one, const ScoredBase& best);

  // SettleParameters: false where it cannot, or shows on the way that it will not beat the best.
  bool Settle(ScoredBase& scored, ScoredBase* best);
  // SmoothParameters of a base that has its value as it was laid out.
  void Smooth(ScoredBase& scored);

 private:
  PointMask CountedOf(const BaseAttempt& made);

  const BaseInput& input_;
  std::optional<BaseScore> score_;
};

}  // namespace batten::internal
