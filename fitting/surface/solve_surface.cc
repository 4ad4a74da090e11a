// SPDX-License-Identifier: MIT
#include "fitting/surface/solve_surface.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "batten/fitting/distances.h"
#include "batten/fitting/solve_linear.h"
#include "fitting/constraints/constrained_surface.h"
#include "fitting/core/rules.h"
#include "fitting/core/shared_constants.h"
#include "fitting/knots/knot_line_removal.h"
#include "fitting/least_squares/choose_smoothing.h"
#include "fitting/least_squares/residual_noise.h"
#include "fitting/surface/bounded_solution.h"
#include "fitting/surface/refine.h"

namespace batten::internal {
namespace {

// The fairness weight chosen from the data.
double Smoothing(const FitContext& context, const FittingProblem& problem) {
  const SurfaceFitOptions& options = context.options();
  ThreadPool& pool = context.pool();
  if (options.smooth_by == SmoothBy::kCrossValidation)
    return SmoothingByCrossValidation(problem, pool, options.progress);
  // The noise of the values: on slopes the noise along the normal is less than that of heights, and
  // over a sheet the parameters absorb the tangential part.
  const Eigen::MatrixXd off =
      problem.data().values - EvaluateAt(problem, SolveLinear(problem, pool).coefficients, pool);
  const auto count = static_cast<double>(problem.size());
  const double left = count - EffectiveFreedom(problem, pool);
  const double variance =
      ResidualNoise(problem.data().parameters).Variance(off, problem.data().weights) * count /
      std::max(1.0, left);
  const double noise = std::sqrt(variance / static_cast<double>(off.rows()));
  if (!(noise > 0)) return problem.smoothing();
  return SmoothingFromNoise(problem, noise, pool, options.progress);
}

// The coarsest grid that cross-validation has tried, up to the one it chose, that keeps the
// tolerance; else the chosen one.
FittingProblem CoarsestWithin(const FitContext& context, const ClassifiedPoints& points) {
  const SurfaceFitOptions& options = context.options();
  for (const TriedGrid& grid : points.tried) {
    if (grid.rms > *options.tolerance) continue;
    if ((grid.cells_u + options.degree_u) * (grid.cells_v + options.degree_v) >=
        points.problem.unknowns())
      continue;
    const FittingProblem coarse = context.WithCells(points.problem, grid.cells_u, grid.cells_v);
    const NurbsSurface surface = context.base().Surface(
        coarse.basis_u(), coarse.basis_v(), SolveLinear(coarse, context.pool()).coefficients);
    const PointDistances found =
        DistancesFrom(surface, points.cloud.points(), coarse.data().parameters, context.pool());
    if (found.distances.cwiseAbs().maxCoeff() <= *options.tolerance) return coarse;
  }
  return points.problem;
}

}  // namespace

SolvedSurface SolveToNoise(const FitContext& context, const ClassifiedPoints& points) {
  const SurfaceFitOptions& options = context.options();
  ThreadPool& pool = context.pool();
  FittingProblem problem = points.problem;
  if (!options.control_points && Acts(Rule::kKnotLines)) {
    // Finer grids would follow noise correlated between neighbours.
    problem = points.noise_is_shared
                  ? PruneKnotLines(problem, pool)
                  : RefineAndPruneKnotLines(problem, options.max_control_points, pool);
  }
  if (options.smooth_by != SmoothBy::kWeight)
    problem = problem.WithSmoothing(Smoothing(context, problem));
  BoundedSolution held = SolveWithinBounds(problem,
                                           context.spacing(),
                                           pool,
                                           options.trim == Trimming::kNone ? HUGE_VAL : 0,
                                           context.noise());
  SolvedSurface solved{
      context.base().Surface(problem.basis_u(), problem.basis_v(), held.solution.coefficients),
      problem.data().parameters,
      problem,
      EndCode::kCrossValidated};
  if (held.in_box)
    solved.warnings.push_back(
        "the points leave parts of the surface open: it was held near their box there");
  if (held.solution.regularised)
    solved.warnings.push_back(
        "the points do not determine every control point: fairness was raised");
  return solved;
}

SolvedSurface RefineWithinTolerance(const FitContext& context, const ClassifiedPoints& points) {
  const SurfaceFitOptions& options = context.options();
  FittingProblem problem =
      options.control_points ? points.problem : CoarsestWithin(context, points);
  RefineResult refined = RefineToTolerance(context, points.cloud.points(), problem);
  // Where parameters are part of the data the joint stage starts from those.
  Eigen::Matrix2Xd parameters =
      context.base().exact ? problem.data().parameters : std::move(refined.parameters);
  return {std::move(refined.surface),
          std::move(parameters),
          std::move(problem),
          refined.end,
          std::move(refined.rounds)};
}

void MeetConditions(const FitContext& context, const PointMask& used, SolvedSurface& solved) {
  const SurfaceFitOptions& options = context.options();
  const FittingProblem problem =
      options.tolerance
          ? context.ProblemOf(used).WithBases(solved.surface.basis_u(), solved.surface.basis_v())
          : solved.problem;
  ConstrainedSolution solution =
      SolveConstrained(problem, ConstraintsOf(context.prepared().conditions), context.pool());
  for (const MissedConstraint& missed : solution.missed) solved.warnings.push_back(missed.Text());
  if (options.control_points && solution.surface.control_points().cols() > problem.net_size()) {
    solved.warnings.push_back(
        "the curves given for edges have more knots than the control points asked for allow: "
        "theirs were taken too");
  }
  solved.surface = std::move(solution.surface);
  solved.parameters = problem.data().parameters;
}

}  // namespace batten::internal
