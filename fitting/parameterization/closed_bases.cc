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

namespace batten::internal {
namespace {

constexpr double kMostEmpty = 0.35;
constexpr double kClearlyRound = 0.02;  // relative misfit; below, no tube is tried

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

// Search for closed bases, kind by kind; members are shared by the kinds.
class Finder {
 public:
  Finder(const GoodPoints& good, const SurfaceFitOptions& options, bool tubes, ThreadPool& pool)
      : good_(good),
        asked_(options.base),
        tubes_(tubes),
        progress_(options.progress),
        pool_(pool) {}

  ClosedBases Run() {
    if (asked_ != BaseShape::kSheet) TryRound();
    if (tubes_ && in_question(BaseShape::kSheet) && !settled_) TryTube();
    if (found_.serving.empty() && asked_ == BaseShape::kAuto) {
      found_.failure_reason =
          "nor are the points a sphere, a torus, a surface of revolution or a tube: one NURBS "
          "surface, a rectangle with edges that may be joined or drawn together, cannot cover "
          "them; fit them in parts (--box, --where)";
    }
    return std::move(found_);
  }

 private:
  bool in_question(BaseShape shape) const { return asked_ == BaseShape::kAuto || asked_ == shape; }

  void TryRound() {
    const CloudStatistics& statistics = good_.statistics;
    const RevolutionSamples nodes =
        good_.nodes ? RevolutionSamplesOf(*good_.nodes, statistics.noise, {})
                    : SampleRevolution(good_.points, good_.index, statistics.noise, {}, pool_);
    if (!nodes.ok()) {
      found_.failure_reason = nodes.failure_reason;
      return;
    }
    RoundCloud cloud{good_.points, nodes, statistics.spacing, statistics.noise, good_.margin};
    Report(progress_, "parameterize", 0.6);
    if (in_question(BaseShape::kSphere) && !settled_) Take(SphereBaseOf(cloud, {}, pool_));
    if (settled_ || !(in_question(BaseShape::kTorus) || in_question(BaseShape::kRevolution)))
      return;
    const RevolutionEstimate shape = FindRevolution(nodes, std::nullopt, pool_);
    cloud.shape = &shape;
    if (in_question(BaseShape::kTorus)) Take(TorusBaseOf(cloud, {}, pool_));
    Report(progress_, "parameterize", 0.7);
    if (in_question(BaseShape::kRevolution) && !settled_) Take(RevolutionBaseOf(cloud, {}, pool_));
  }

  void Take(RevolutionParameterization round) {
    if (!round.ok()) {
      found_.failure_reason = std::move(round.failure_reason);
      return;
    }
    const PointMask all = PointMask::Constant(good_.points.cols(), true);
    const double empty = EmptyAreaFraction(round.parameters, all, round.length_u, round.length_v);
    if (empty > kMostEmpty) {
      found_.failure_reason = "the points leave " + std::to_string(std::lround(100 * empty)) +
                              " % of the " + round.name + " they were taken for open";
      return;
    }
    Parameterization base;
    base.name = std::move(round.name);
    base.why = asked_ == BaseShape::kAuto ? std::move(round.why) : "asked for; " + round.why;
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
    settled_ = round.misfit < kClearlyRound;
    found_.failure_reason.clear();
    PointMask inside = Inside(base);
    found_.serving.push_back({std::move(base), std::move(inside)});
  }

  void TryTube() {
    TubeBase tube = FlattenTube(good_.points,
                                good_.index,
                                good_.statistics.spacing,
                                good_.statistics.noise,
                                good_.margin,
                                {},
                                pool_,
                                progress_);
    if (!tube.ok()) {
      if (found_.serving.empty()) found_.failure_reason = std::move(tube.failure_reason);
      return;
    }
    Parameterization base;
    base.name = "sheet";
    base.why = std::move(tube.why);
    base.shape = "a smooth tube";
    base.parameters = std::move(tube.parameters);
    base.length_u = tube.length_u;
    base.length_v = tube.length_v;
    base.periodic_u = true;
    found_.failure_reason.clear();
    found_.serving.push_back({std::move(base), std::move(tube.reached)});
  }

  const GoodPoints& good_;
  BaseShape asked_;
  bool tubes_;
  const Progress& progress_;
  ThreadPool& pool_;
  bool settled_ = false;  // no other base can be better
  ClosedBases found_;
};

}  // namespace

ClosedBases FindClosedBases(const GoodPoints& good,
                            const SurfaceFitOptions& options,
                            bool tubes,
                            ThreadPool& pool) {
  return Finder(good, options, tubes, pool).Run();
}

}  // namespace batten::internal
