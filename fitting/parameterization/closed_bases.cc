// SPDX-License-Identifier: MIT
#include "fitting/parameterization/closed_bases.h"

#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "fitting/flattening/tube_base.h"
#include "fitting/parameterization/empty_area_fraction.h"
#include "fitting/revolution/revolution_base.h"
#include "fitting/revolution/revolution_shape.h"
#include "geometry/numeric/number_text.h"

namespace batten::internal {
namespace {

constexpr double kMostEmpty = 0.35;     // share of the rectangle
constexpr double kClearlyRound = 0.02;  // relative misfit

// Points inside the open edges. Points beyond an edge were given a place on it: they are outliers.
PointMask Inside(const Parameterization& base) {
  const auto u = base.parameters.row(0).array(), v = base.parameters.row(1).array();
  PointMask inside = PointMask::Constant(base.parameters.cols(), true);
  if (!base.periodic_u) inside = inside && (u > 0 && u < base.length_u).transpose();
  if (!base.periodic_v && base.poles.start == PoleKind::kNone) {
    inside = inside && (v > 0).transpose();
  }
  if (!base.periodic_v && base.poles.end == PoleKind::kNone) {
    inside = inside && (v < base.length_v).transpose();
  }
  return inside;
}

// Samples and the axis of a round shape, found once for all candidates that need them.
class RoundShape {
 public:
  RoundShape(const BaseInput& input, std::shared_ptr<SheetFlattening> flattening)
      : input_(input), flattening_(std::move(flattening)) {}

  const RevolutionSamples& samples() {
    if (!samples_) {
      const double noise = input_.statistics.noise;
      const PoissonDiskSamples* nodes = flattening_->nodes();
      samples_ = nodes ? RevolutionSamplesOf(*nodes, noise)
                       : SampleRevolution(input_.inliers(), input_.index(), noise, input_.pool);
      Report(input_.options.progress, "parameterize", 0.6);
    }
    return *samples_;
  }

  const RevolutionEstimate& estimate() {
    if (!estimate_) {
      estimate_ = FindRevolution(samples(), input_.pool);
      Report(input_.options.progress, "parameterize", 0.7);
    }
    return *estimate_;
  }

 private:
  const BaseInput& input_;
  std::shared_ptr<SheetFlattening> flattening_;
  std::optional<RevolutionSamples> samples_;
  std::optional<RevolutionEstimate> estimate_;
};

using RoundFit = RevolutionParameterization (*)(const RoundCloud&, ThreadPool&);

BaseAttempt OverRound(const BaseInput& input,
                      RoundShape& shape,
                      RoundFit fit,
                      bool needs_axis,
                      const InlierSubset& some) {
  if (!shape.samples().ok()) return Failure(shape.samples().failure_reason);
  const Eigen::Matrix3Xd part =
      some ? input.inliers()(Eigen::all, *some).eval() : Eigen::Matrix3Xd(3, 0);
  const CloudStatistics& statistics = input.statistics;
  RevolutionParameterization round = fit({some ? part : input.inliers(),
                                          shape.samples(),
                                          statistics.spacing,
                                          statistics.noise,
                                          input.margin(),
                                          needs_axis ? &shape.estimate() : nullptr},
                                         input.pool);
  if (!round.ok()) return Failure(std::move(round.failure_reason));
  const PointMask all = PointMask::Constant(round.parameters.cols(), true);
  const double empty = EmptyAreaFraction(round.parameters, all, round.length_u, round.length_v);
  if (empty > kMostEmpty) {
    return Failure("the points leave " + std::to_string(std::lround(100 * empty)) + " % of the " +
                   round.name + " they were taken for open");
  }
  Parameterization base;
  base.name = std::move(round.name);
  base.why =
      input.options.base == BaseShape::kAuto ? std::move(round.why) : "asked for; " + round.why;
  base.shape = base.name == "revolution" ? "a smooth surface of revolution or one near it"
                                         : "a smooth surface near a " + base.name;
  base.parameters = std::move(round.parameters);
  base.length_u = round.length_u;
  base.length_v = round.length_v;
  base.periodic_u = round.periodic_u;
  base.periodic_v = round.periodic_v;
  if (round.pole_start) base.poles.start = PoleKind::kSmooth;
  if (round.pole_end) base.poles.end = PoleKind::kSmooth;
  base.poles.turn = round.turn;
  const PointMask inside = Inside(base);
  BaseAttempt made = Attempt(input, some, std::move(base), inside);
  made.certain = round.misfit < kClearlyRound;
  return made;
}

BaseAttempt OverTube(const BaseInput& input) {
  FlattenedBase tube = FlattenTube(input.inliers(),
                                   input.index(),
                                   input.statistics.spacing,
                                   input.statistics.noise,
                                   input.margin(),
                                   input.pool,
                                   input.options.progress);
  if (!tube.ok()) return Failure(std::move(tube.failure_reason));
  Parameterization base;
  base.name = "sheet";
  base.why = "closed round with two open ends, lengths change by " + Percent(tube.distortion);
  base.shape = "a smooth tube";
  base.parameters = std::move(tube.parameters);
  base.length_u = tube.length_u;
  base.length_v = tube.length_v;
  base.periodic_u = true;
  return Attempt(input, std::nullopt, std::move(base), tube.reached);
}

}  // namespace

std::vector<BaseMethod> ClosedCandidates(const BaseInput& input,
                                         bool tubes,
                                         std::shared_ptr<SheetFlattening> flattening) {
  struct Kind {
    const char* name;
    BaseShape shape;
    RoundFit fit;
    bool needs_axis;
  };
  const BaseShape asked = input.options.base;
  const auto shape = std::make_shared<RoundShape>(input, std::move(flattening));
  std::vector<BaseMethod> candidates;
  for (const Kind& kind : {Kind{"sphere", BaseShape::kSphere, SphereBaseOf, false},
                           Kind{"torus", BaseShape::kTorus, TorusBaseOf, true},
                           Kind{"revolution", BaseShape::kRevolution, RevolutionBaseOf, true}}) {
    if (asked != BaseShape::kAuto && asked != kind.shape) continue;
    candidates.push_back({kind.name, [&input, shape, kind](const InlierSubset& some) {
                            return OverRound(input, *shape, kind.fit, kind.needs_axis, some);
                          }});
  }
  if (tubes && (asked == BaseShape::kAuto || asked == BaseShape::kSheet))
    candidates.push_back({"tube", [&input](const InlierSubset&) { return OverTube(input); }});
  return candidates;
}

}  // namespace batten::internal
