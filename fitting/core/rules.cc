// SPDX-License-Identifier: MIT
#include "fitting/core/rules.h"

#include <bitset>

namespace batten::internal {
namespace {

std::bitset<64> switched_off;

}  // namespace

std::vector<NamedRule> AllRules() {
  return {{Rule::kLocalOutliers, "local-outliers"},
          {Rule::kIsolatedPoints, "isolated-points"},
          {Rule::kClutter, "clutter"},
          {Rule::kCertainBase, "certain-base"},
          {Rule::kHopelessBases, "hopeless-bases"},
          {Rule::kSmoothedParameters, "smoothed-parameters"},
          {Rule::kOutlineBase, "outline-base"},
          {Rule::kBlockValidation, "block-validation"},
          {Rule::kReweighting, "reweighting"},
          {Rule::kNeighbourVotes, "neighbour-votes"},
          {Rule::kKnotLines, "knot-lines"},
          {Rule::kBounds, "bounds"},
          {Rule::kHeldBetween, "held-between"},
          {Rule::kJointStage, "joint-stage"},
          {Rule::kStructuredGate, "structured-gate"},
          {Rule::kCorners, "corners"},
          {Rule::kRelocatedKnots, "relocated-knots"},
          {Rule::kLeastAbsolute, "least-absolute"},
          {Rule::kOvershoot, "overshoot"}};
}

bool Acts(Rule rule) { return !switched_off[static_cast<std::size_t>(rule)]; }

void SwitchOff(Rule rule) { switched_off.set(static_cast<std::size_t>(rule)); }

}  // namespace batten::internal
