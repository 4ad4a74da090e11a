// SPDX-License-Identifier: MIT
#include "fitting/parameterization/wing_candidate.h"

#include <string>
#include <utility>

#include "fitting/wings/wing_layout.h"

namespace batten::internal {
namespace {

BaseAttempt OverWing(const BaseInput& input) {
  WingParameters wing = LayWing(input.cloud.points(),
                                NeighbourIndex(input.cloud.points(), input.pool),
                                input.statistics.noise,
                                input.margin(),
                                input.pool);
  if (!wing.ok()) return Failure(std::move(wing.failure_reason));
  BaseAttempt made{{}, PointMask::Constant(input.cloud.size(), true)};
  Parameterization& base = made.base;
  base.name = "sheet";
  base.why =
      std::string(input.options.base == BaseShape::kWing ? "asked for; " : "") +
      "the points are a thin closed section: its sides are told apart by their normals, laid out "
      "as one sheet round the nose, and joined along a sharp edge";
  base.shape = "a smooth sheet that closes at a sharp edge";
  base.parameters = std::move(wing.parameters);
  base.length_u = wing.length_u;
  base.length_v = wing.length_v;
  base.sharp_edge = std::move(wing.edge);
  return made;
}

}  // namespace

BaseMethod WingCandidate(const BaseInput& input) {
  return {.name = "wing",
          .make = [&input](const InlierSubset&) { return OverWing(input); },
          .of_two_sheets = true};
}

}  // namespace batten::internal
