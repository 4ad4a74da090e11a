// SPDX-License-Identifier: MIT
#include "fitting/curve/curve_fitter.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "fitting/core/input_summary.h"
#include "fitting/curve/curve_joint.h"
#include "fitting/curve/curve_outcome.h"
#include "fitting/curve/fit_corners.h"
#include "fitting/curve/solve_curve.h"

namespace batten::internal {
namespace {

SolvedCurve Solve(CurveTask& task, const PointMask& sequence_outliers) {
  if (!task.by_feet() && !task.ordered.closed) return SolveAtParameters(task);
  if (task.options.smooth_by != SmoothBy::kWeight) return SolveSmoothly(task);
  if (task.options.control_points) return SolveWithControlPoints(task);
  return SolveAdaptively(task, sequence_outliers.count(), sequence_outliers.size());
}

// Whether inner knots were placed by the data, and not equally.
bool PlacedByData(const SplineBasis& basis) {
  constexpr double kEqual = 1e-6;  // of a span: rounding, and what cutting to the data leaves
  double least = HUGE_VAL, most = 0;
  for (const int span : basis.Spans()) {
    const double length =
        basis.knots()[static_cast<size_t>(span) + 1] - basis.knots()[static_cast<size_t>(span)];
    least = std::min(least, length);
    most = std::max(most, length);
  }
  return most > least * (1 + kEqual);
}

// Weights count as free where the joint stage freed them, knots where the data placed them; a loss
// nobody asked for is Tukey's.
void SetEstimator(const CurveTask& task,
                  const SolvedCurve& solved,
                  bool joint,
                  FitEstimator& estimator) {
  estimator.refused.clear();
  if (task.options.terms) estimator.refused = "the user's terms shape it beside the points";
  estimator.smoothing = solved.problem.smoothing();
  estimator.energy = solved.problem.energy();
  const Eigen::VectorXd &weights = solved.problem.data().weights,
                        &own = task.problem.data().weights;
  const bool weighed = weights.size() > 0 && (own.size() == 0 || weights != own);
  const bool bounded = weighed && weights.minCoeff() < weights.maxCoeff();
  estimator.loss = task.options.loss.value_or(bounded ? Loss::kTukey : Loss::kNone);
  estimator.loss_scale = task.options.loss_scale;
  if (joint) estimator.freed = task.options.optimize.value_or(FreeVariables{.parameters = true});
  estimator.freed.knots = PlacedByData(solved.problem.basis_u());
  estimator.freed.weights =
      solved.weights.size() > 0 && solved.weights.minCoeff() < solved.weights.maxCoeff();
  estimator.shift = task.options.shift;
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
  FitReport report;
  report.threads = pool.threads();
  report.input = SummariseInput(cloud, ordered.repeats, ordered.spacing, ordered.noise);
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
  CurveFit<Dim> fit = MeasuredCurve<Dim>(task, solved, cloud, sequence_outliers, std::move(report));
  SetEstimator(task, solved, fit.report.optimize.ran, fit.estimator);
  return fit;
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
