// SPDX-License-Identifier: MIT
#include "fitting/curve/curve_fitter.h"

#include <utility>

#include "fitting/curve/curve_joint.h"
#include "fitting/curve/curve_outcome.h"
#include "fitting/curve/solve_curve.h"

namespace batten::internal {
namespace {

FitReport StartReport(const PointCloud& cloud, const OrderedPoints& ordered, ThreadPool& pool) {
  FitReport report;
  report.threads = pool.threads();
  InputSummary& input = report.input;
  input.points = cloud.size();
  input.duplicates = ordered.repeats;
  input.spacing = ordered.spacing;
  input.noise = ordered.noise;
  input.origin = cloud.origin();
  input.box_min = cloud.origin() + cloud.points().rowwise().minCoeff();
  input.box_max = cloud.origin() + cloud.points().rowwise().maxCoeff();
  return report;
}

SolvedCurve Solve(CurveTask& task, const PointMask& sequence_outliers) {
  if (!task.by_feet() && !task.ordered.closed) return SolveAtParameters(task);
  if (task.options.smooth_by != SmoothBy::kWeight) return SolveSmoothly(task);
  if (task.options.control_points) return SolveWithControlPoints(task);
  return SolveAdaptively(task, sequence_outliers.count(), sequence_outliers.size());
}

}  // namespace

template <int Dim>
CurveFit<Dim> FitOrdered(const PointCloud& cloud,
                         const OrderedPoints& ordered,
                         const PointMask& sequence_outliers,
                         const CurveFitOptions& options,
                         ThreadPool& pool,
                         StageClock& clock) {
  Report(options.progress, "prepare", 0);
  FitReport report = StartReport(cloud, ordered, pool);
  CurveTask task = MakeCurveTask(ordered, options, Dim, pool);
  clock.Enter(&StageSeconds::parameterize);
  FindCorners(task);
  const bool refined = !task.by_feet() && !ordered.closed && options.tolerance;
  clock.Enter(refined ? &StageSeconds::refine : &StageSeconds::solve);
  SolvedCurve solved = Solve(task, sequence_outliers);
  PullIn(task, solved);
  ImproveJointly<Dim>(task, solved, clock, report.optimize);
  report.iterations = std::move(solved.rounds);
  report.warnings = std::move(solved.warnings);
  report.end.code = solved.end;
  clock.Enter(&StageSeconds::project);
  return MeasuredCurve<Dim>(
      {cloud,
       ordered,
       sequence_outliers,
       options,
       solved.problem.data().weights,
       solved.problem.data().parameters.row(0).transpose(),
       task.distance,
       task.noise,
       solved.problem.unknowns()},
      NurbsCurve<Dim>(solved.problem.basis_u(), solved.control_points, solved.weights),
      task.middle,
      std::move(report),
      pool);
}

template CurveFit<2> FitOrdered<2>(const PointCloud&,
                                   const OrderedPoints&,
                                   const PointMask&,
                                   const CurveFitOptions&,
                                   ThreadPool&,
                                   StageClock&);
template CurveFit<3> FitOrdered<3>(const PointCloud&,
                                   const OrderedPoints&,
                                   const PointMask&,
                                   const CurveFitOptions&,
                                   ThreadPool&,
                                   StageClock&);

}  // namespace batten::internal
