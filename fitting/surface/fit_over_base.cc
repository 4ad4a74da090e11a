// SPDX-License-Identifier: MIT
#include "fitting/surface/fit_over_base.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "fitting/surface/base_borders.h"
#include "fitting/surface/solve_surface.h"

namespace batten::internal {
namespace {

template <typename T>
void Append(std::vector<T>& list, const std::vector<T>& more) {
  list.insert(list.end(), more.begin(), more.end());
}

// In a periodic direction the last control points repeat the first.
void RequireRoomToClose(const SurfaceFitOptions& options, const Parameterization& base) {
  const auto least = [](bool periodic, int degree) {
    return periodic ? 2 * degree + 1 : degree + 1;
  };
  const int least_u = least(base.periodic_u, options.degree_u),
            least_v = least(base.periodic_v, options.degree_v);
  const auto reject = [](const std::string& what, int degree, int count) {
    throw std::invalid_argument(what + " are too few: in a closed direction the last " +
                                std::to_string(degree) + " repeat the first, so at least " +
                                std::to_string(count) + " are needed");
  };
  if (!options.control_points) {
    if (options.max_control_points >= least_u * least_v) return;
    reject("max_control_points: " + std::to_string(options.max_control_points),
           base.periodic_u ? options.degree_u : options.degree_v,
           least_u * least_v);
  }
  const auto require = [&](int count, int degree, int needed) {
    if (count >= needed) return;
    reject("control_points: " + std::to_string(count) + " of degree " + std::to_string(degree),
           degree,
           needed);
  };
  require(options.control_points->first, options.degree_u, least_u);
  require(options.control_points->second, options.degree_v, least_v);
}

// How the linear stage found the surface.
FitEstimator EstimatorOf(const PreparedCloud& prepared,
                         const SurfaceFitOptions& options,
                         const FittingProblem& problem,
                         bool robust) {
  FitEstimator estimator;
  estimator.refused.clear();
  estimator.smoothing = problem.smoothing();
  estimator.energy = problem.energy();
  estimator.loss = robust ? options.loss.value_or(Loss::kTukey) : Loss::kNone;
  estimator.loss_scale = options.loss_scale;
  estimator.poles = prepared.base.poles;
  for (const PlacedBoundary& side : prepared.conditions.sides)
    estimator.held_edges.push_back({side.edge, side.side.neighbour ? 2 : 1});
  const auto& points = prepared.conditions.points;
  estimator.held_points.resize(2, std::ssize(points));
  for (size_t k = 0; k < points.size(); ++k)
    estimator.held_points.col(static_cast<Eigen::Index>(k)) << points[k].u, points[k].v;
  return estimator;
}

// The surface before the joint stage, and what the stages so far say.
FittedState Solved(const PreparedCloud& prepared,
                   const SurfaceFitOptions& options,
                   FitReport report,
                   ThreadPool& pool,
                   StageClock& clock) {
  RequireRoomToClose(options, prepared.base);
  RequireDataFor(options, prepared.used.count());
  FitContext context(prepared, options, pool);
  clock.Enter(&StageSeconds::solve);
  ClassifiedPoints points = ClassifyInliers(context);
  if (options.tolerance) clock.Enter(&StageSeconds::refine);
  SolvedSurface solved =
      options.tolerance ? RefineWithinTolerance(context, points) : SolveToNoise(context, points);
  clock.Enter(&StageSeconds::solve);
  if (prepared.conditions.any()) MeetConditions(context, points.used, solved);
  if (points.noise_is_shared) {
    solved.warnings.push_back(
        "neighbouring points share their noise: blocks of left-out points are predicted better "
        "with fewer control points than single ones ask for, and those were taken");
  }
  Append(report.iterations, points.rounds);
  Append(report.iterations, solved.rounds);
  Append(report.warnings, solved.warnings);
  report.end.code = solved.end;
  FitEstimator estimator = EstimatorOf(prepared, options, solved.problem, points.robust);
  const bool doubted =
      !options.loss && !options.keep_outliers && (points.robust || !points.used.all());
  return {{std::move(solved.surface),
           std::move(points.cloud),
           std::move(solved.parameters),
           solved.problem.data().weights,
           prepared.base.poles,
           points.robust,
           points.noise_is_shared,
           std::move(estimator)},
          std::move(points.used),
          doubted,
          std::move(report)};
}

}  // namespace

void RequireDataFor(const SurfaceFitOptions& options, Eigen::Index points) {
  constexpr Eigen::Index kAlways = 10000, kForEach = 10;
  if (!options.control_points) return;
  const auto& [u, v] = *options.control_points;
  const Eigen::Index most = std::max(kAlways, kForEach * points);
  if (Eigen::Index{u} * v <= most) return;
  throw std::invalid_argument("control_points: " + std::to_string(u) + " x " + std::to_string(v) +
                              " are far more than " + std::to_string(points) +
                              " points determine: at most " + std::to_string(most) + " for them");
}

FittedState FitOverBase(const PreparedCloud& prepared,
                        const SurfaceFitOptions& options,
                        FitReport start,
                        ThreadPool& pool,
                        StageClock& clock) {
  FittedState fitted = Solved(prepared, options, std::move(start), pool, clock);
  FitReport& report = fitted.report;
  if (prepared.conditions.any()) {
    report.optimize.why = "the surface meets conditions, which free points would leave";
  } else {
    const auto held = [&] {
      return FillBase(prepared, fitted.used, pool) ? BesideBorders(prepared, fitted.used)
                                                   : std::vector<std::uint8_t>();
    };
    OptimiseWhereItPays(fitted.draft, options, held, pool, clock, report);
  }
  const Poles& poles = prepared.base.poles;
  report.geometry.distortion = DistortionAt(fitted.draft.surface, fitted.draft.parameters);
  report.geometry.poles = {poles.start != PoleKind::kNone, poles.end != PoleKind::kNone};
  return fitted;
}

}  // namespace batten::internal
