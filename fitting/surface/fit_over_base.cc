// SPDX-License-Identifier: MIT
#include "fitting/surface/fit_over_base.h"

#include <utility>

#include "fitting/surface/solve_surface.h"

namespace batten::internal {
namespace {

template <typename T>
void Append(std::vector<T>& list, const std::vector<T>& more) {
  list.insert(list.end(), more.begin(), more.end());
}

// The surface before the joint stage, and what the stages so far say.
FittedState Solved(const PreparedCloud& prepared,
                   const SurfaceFitOptions& options,
                   FitReport report,
                   ThreadPool& pool,
                   StageClock& clock) {
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
  const bool doubted =
      !options.loss && !options.keep_outliers && (points.robust || !points.used.all());
  return {{std::move(solved.surface),
           std::move(points.cloud),
           std::move(solved.parameters),
           solved.problem.data().weights,
           prepared.base.poles,
           points.robust,
           points.noise_is_shared},
          std::move(points.used),
          solved.empty_area_fraction,
          doubted,
          std::move(report)};
}

}  // namespace

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
    OptimiseWhereItPays(fitted.draft, options, pool, clock, report);
  }
  const Poles& poles = prepared.base.poles;
  report.geometry.distortion = DistortionAt(fitted.draft.surface, fitted.draft.parameters);
  report.geometry.poles = {poles.start != PoleKind::kNone, poles.end != PoleKind::kNone};
  return fitted;
}

}  // namespace batten::internal
