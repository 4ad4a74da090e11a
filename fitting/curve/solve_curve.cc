// SPDX-License-Identifier: MIT
#include "fitting/curve/solve_curve.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "batten/fitting/curve_spans.h"
#include "batten/fitting/solve_linear.h"
#include "fitting/core/rules.h"
#include "fitting/curve/curve_adaptation.h"
#include "fitting/curve/knot_relocation.h"
#include "fitting/curve/overshoot.h"
#include "fitting/curve/parameter_correction.h"
#include "fitting/least_squares/choose_smoothing.h"
#include "fitting/least_squares/reweighting.h"
#include "fitting/ordering/row_means.h"

namespace batten::internal {
namespace {

constexpr int kBasisPasses = 2;  // weights choose spans, spans choose weights
constexpr double kFirstRegularization = 1e-8, kLastRegularization = 1e9, kRegularizationStep = 10;
constexpr double kManyOutliers = 0.003;  // share of the points: above it some were missed
constexpr int kPointsOfSmoothSpan = 3, kMostSmoothSpans = 200;
constexpr double kFewForControlPoint = 4;  // data
constexpr double kMostFairnessOfDistance = 1e-4;

void TellOnce(const std::string& warning, SolvedCurve& solved) {
  std::vector<std::string>& told = solved.warnings;
  if (std::find(told.begin(), told.end(), warning) == told.end()) told.push_back(warning);
}

void Take(const LinearSolution& solution, SolvedCurve& solved) {
  solved.squares = solution.residual_squares;
  solved.control_points = solution.coefficients;
  if (solution.regularised)
    TellOnce("the points do not determine every control point: fairness was raised", solved);
}

SplineBasis Uniform(const CurveTask& task, int control_points) {
  return SplineBasis::Uniform(
      task.options.degree, control_points, task.ordered.lower, task.ordered.upper);
}

void Reweight(const CurveTask& task, const FittingProblem& problem, SolvedCurve& solved) {
  solved.problem = Reweighted(
      problem,
      {.loss = *task.options.loss,
       .loss_scale = task.options.loss_scale,
       .progress = task.options.progress},
      [&](const FittingProblem& current, const LinearSolution& solution) {
        return CurveDistances(current, solution.coefficients, task.distance, task.pool);
      },
      task.pool,
      solved.rounds);
}

EndCode SearchEnd(Termination termination) {
  return termination == Termination::kToleranceReached   ? EndCode::kToleranceReached
         : termination == Termination::kMaxControlPoints ? EndCode::kMaxControlPoints
         : termination == Termination::kCancelled        ? EndCode::kCancelled
                                                         : EndCode::kCrossValidated;
}

void RefineAtParameters(const CurveTask& task, SolvedCurve& solved) {
  const CurveFitOptions& options = task.options;
  if (!options.control_points)
    solved.problem = solved.problem.WithBasis(Uniform(task, options.degree + 1));
  SpanRefineOptions refine;
  refine.tolerance = *options.tolerance;
  refine.distance = task.distance;
  refine.noise = task.ordered.noise;
  refine.max_control_points = options.control_points.value_or(options.max_control_points);
  SpanRefinement refined = RefineSpans(solved.problem, refine, task.pool, options.progress);
  solved.rounds.insert(solved.rounds.end(), refined.rounds.begin(), refined.rounds.end());
  solved.end = SearchEnd(refined.termination);
  solved.problem = std::move(refined.problem);
  Take(refined.solution, solved);
}

// Layouts with as many spans as `even`, adapted to the data: with the density that adaptation
// finds, and both with relocated knots.
std::vector<SpanLayout> SpreadLayouts(const CurveTask& task, const SpanLayout& even) {
  const int spans = even.spans();
  if (spans <= 1 + static_cast<int>(task.corners.size())) return {};
  SpanAdaptOptions adapt = AdaptOptions(task);
  adapt.tolerance.reset();
  const bool many = task.problem.size() > kManyCurvePoints;
  const FittingProblem problem = many ? MeansOfRows(task.problem, kCurveMeans) : task.problem;
  const int start = std::min(kStartSpans, spans);
  const SpanAdaptation free =
      AdaptSpans(problem, task.EqualSpans(start, task.corners), adapt, task.pool);
  std::vector<SpanLayout> layouts{free.layout.Resampled(spans)};
  if (spans > kMostSpansToRelocate) return layouts;
  const LayoutTrials trials(free.problem, spans);
  layouts.push_back(RelocateKnots(trials, layouts.front()));
  layouts.push_back(RelocateKnots(trials, even));
  return layouts;
}

// A net of least distances to its data may fold back between them, where no datum is farther for
// it: then with as little fairness as ends that, or as it was.
CorrectedFit AtMinimumDistanceBetweenData(const CurveTask& task, const CorrectedFit& fit) {
  DistanceMinimisationOptions minimise;
  minimise.model = task.model.value_or(DistanceModel::kTangent);
  if (!task.model) minimise.max_rounds = kRoundsOfDistance;
  minimise.progress = task.options.progress;
  const auto overshoots = [&](const CorrectedFit& at) {
    return HasOvershoot(at.problem, at.solution.coefficients, {}, task.noise) ||
           TurnsBack(at.problem, at.solution.coefficients, task.noise);
  };
  CorrectedFit found = AtMinimumDistance(fit, minimise, task.pool);
  if (!Acts(Rule::kOvershoot) || !overshoots(found) || overshoots(fit)) return found;
  for (double smoothing = kFirstRegularization; smoothing <= kMostFairnessOfDistance;
       smoothing *= kRegularizationStep) {
    if (smoothing <= fit.problem.smoothing()) continue;
    CorrectedFit fair = fit;
    fair.problem = fair.problem.WithSmoothing(smoothing);
    found = AtMinimumDistance(fair, minimise, task.pool);
    if (!overshoots(found)) return found;
  }
  return fit;
}

// Makes the last fits on all data.
void Settle(const CurveTask& task,
            FittingProblem problem,
            const SpanLayout& layout,
            SolvedCurve& solved) {
  // Of many points one step says as much.
  const int steps = !task.by_feet() ? 0 : problem.size() > kManyCurvePoints ? 1 : kFootPointSteps;
  CorrectedFit fit = FitWithCorrection(problem, steps, task.pool, task.anchored);
  // Of few points the parameters are the larger part of the error.
  const bool few =
      static_cast<double>(problem.size()) < kFewForControlPoint * layout.control_points();
  if (steps > 0 && (task.model || (task.anchored.empty() && (few || task.options.tolerance)))) {
    fit = AtMinimumDistanceBetweenData(task, fit);
    RoundSummary round;
    round.stage = task.model == DistanceModel::kSquared ? "squared distance" : "tangent distance";
    round.control_points_u = problem.unknowns();
    round.control_points_v = 1;
    round.rms = std::sqrt(fit.solution.residual_squares / static_cast<double>(problem.size()));
    round.score = fit.steps;
    solved.rounds.push_back(round);
  }
  solved.problem = std::move(fit.problem);
  Take(fit.solution, solved);
}

}  // namespace

void PullIn(const CurveTask& task, SolvedCurve& solved) {
  for (double smoothing = kFirstRegularization;
       smoothing <= kLastRegularization && Acts(Rule::kOvershoot);
       smoothing *= kRegularizationStep) {
    if (!HasOvershoot(solved.problem, solved.control_points, {}, task.noise)) break;
    if (smoothing <= solved.problem.smoothing()) continue;
    solved.problem = solved.problem.WithSmoothing(smoothing);
    TellOnce("the points leave parts of the curve open: fairness was raised there and everywhere",
             solved);
    const LinearSolution solution = SolveLinear(solved.problem, task.pool);
    solved.squares = solution.residual_squares;
    solved.control_points = solution.coefficients;
  }
}

SolvedCurve SolveAtParameters(const CurveTask& task) {
  const CurveFitOptions& options = task.options;
  SolvedCurve solved{task.problem, {}};
  const bool robust = options.loss && *options.loss != Loss::kNone;
  const int passes = robust && !options.control_points ? kBasisPasses : 1;
  for (int pass = 0; pass < passes; ++pass) {
    if (options.control_points) {
      solved.problem = solved.problem.WithBasis(Uniform(task, *options.control_points));
    } else if (robust || !options.tolerance) {
      SpanChoice choice =
          ChooseSpans(solved.problem, options.max_control_points, task.pool, options.progress);
      solved.problem = std::move(choice.problem);
      solved.rounds.insert(solved.rounds.end(), choice.rounds.begin(), choice.rounds.end());
    }
    if (robust) Reweight(task, task.problem.WithBasis(solved.problem.basis_u()), solved);
  }
  if (options.tolerance) {
    RefineAtParameters(task, solved);
  } else {
    Take(SolveLinear(solved.problem, task.pool), solved);
  }
  return solved;
}

SolvedCurve SolveSmoothly(const CurveTask& task) {
  const CurveFitOptions& options = task.options;
  const bool closed = task.ordered.closed;
  const auto most = static_cast<int>(task.problem.size() / kPointsOfSmoothSpan);
  const int beside =
      (closed ? 0 : options.degree) + (options.degree - 1) * static_cast<int>(task.corners.size());
  const int spans = options.control_points
                        ? *options.control_points - beside
                        : std::min({most, kMostSmoothSpans, options.max_control_points - beside});
  const SpanLayout layout = task.EqualSpans(
      std::max(closed && task.corners.empty() ? options.degree + 1 : 1, spans), task.corners);
  FittingProblem problem = task.problem.WithBasis(layout.Basis());
  for (int pass = 0; pass < 2; ++pass) {
    problem = problem.WithSmoothing(
        options.smooth_by == SmoothBy::kNoise
            ? SmoothingFromNoise(
                  problem,
                  std::max({task.ordered.noise, kCurvesAlike * task.size, kTiniestScale}),
                  task.pool,
                  options.progress)
            : SmoothingByCrossValidation(problem, task.pool, options.progress));
    problem = FitWithCorrection(problem, task.by_feet() ? 1 : 0, task.pool, task.anchored).problem;
  }
  SolvedCurve solved{std::move(problem), {}};
  Take(SolveLinear(solved.problem, task.pool), solved);
  return solved;
}

SolvedCurve SolveWithControlPoints(const CurveTask& task) {
  const CurveFitOptions& options = task.options;
  const int asked = *options.control_points;
  const int ends = task.ordered.closed ? 0 : options.degree;
  const int spans = asked - ends - (options.degree - 1) * static_cast<int>(task.corners.size());
  const int steps = task.by_feet() ? kFootPointSteps : 0;
  SpanLayout layout = task.EqualSpans(spans, task.corners);
  CorrectedFit fit =
      FitWithCorrection(task.problem.WithBasis(layout.Basis()), steps, task.pool, task.anchored);
  for (const SpanLayout& other : SpreadLayouts(task, layout)) {
    CorrectedFit trial =
        FitWithCorrection(task.problem.WithBasis(other.Basis()), steps, task.pool, task.anchored);
    if (!(trial.solution.residual_squares < fit.solution.residual_squares)) continue;
    fit = std::move(trial);
    layout = other;
  }
  SolvedCurve solved{fit.problem, {}};
  solved.end = EndCode::kMaxControlPoints;
  if (options.loss && *options.loss != Loss::kNone) Reweight(task, fit.problem, solved);
  Settle(task, solved.problem, layout, solved);
  return solved;
}

SolvedCurve SolveAdaptively(CurveTask& task, Eigen::Index outliers, Eigen::Index points) {
  std::optional<Loss> loss = task.options.loss;
  const bool noisy = task.ordered.noise > 0;  // else what is off is the curve
  if (!loss && noisy && static_cast<double>(outliers) > kManyOutliers * static_cast<double>(points))
    loss = Loss::kTukey;
  if (loss == Loss::kNone) loss.reset();
  SolvedCurve solved{task.problem, {}};
  SpanAdaptation adapted = AdaptedToPoints(task, loss, solved.rounds);
  if (adapted.full) solved.end = EndCode::kMaxControlPoints;
  Settle(task, std::move(adapted.problem), adapted.layout, solved);
  return solved;
}

}  // namespace batten::internal
