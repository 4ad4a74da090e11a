// SPDX-License-Identifier: MIT
#include "fitting/curve/curve_joint.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "batten/fitting/optimize.h"
#include "fitting/core/point_rank.h"
#include "fitting/core/rounding.h"
#include "fitting/curve/curve_adaptation.h"
#include "fitting/curve/curve_cut.h"
#include "fitting/curve/overshoot.h"
#include "fitting/curve/rational_spans.h"
#include "fitting/joint/moved_terms.h"

namespace batten::internal {
namespace {

constexpr double kLargest = 1.3;  // largest size of a joint result over the points'
constexpr double kExcessToOptimise =
    1.1;  // rms residual over noise: below, no joint optimization without a tolerance
constexpr double kPointsPerFreedomToOptimise = 3, kPointsPerFreedomForTolerance = 2;

// The residual that noise leaves of a point: plane points in space are noisy in the plane only.
double NoiseLeft(const CurveTask& task) {
  const int along = task.by_feet() ? 1 : 0;
  return std::sqrt(std::max(1, PointRank(task.problem.data().values) - along)) * task.noise;
}

double Rounding(const CurveTask& task) { return kRelativelyEqual * task.size; }

void SetUp(const CurveTask& task,
           const FittingProblem& problem,
           const Eigen::VectorXd& distances,
           OptimizeOptions& optimize) {
  const CurveFitOptions& options = task.options;
  optimize.loss = options.loss.value_or(Loss::kNone);
  optimize.loss_scale =
      options.loss_scale.value_or(std::max(RobustScale(distances), kTiniestScale));
  optimize.fairness = std::min(optimize.fairness, problem.smoothing());
  optimize.seed = options.seed;
  optimize.progress = options.progress;
}

// The user's terms for the curve so far, in the coordinates of the task.
ResidualTerms TermsOf(const CurveTask& task, const SolvedCurve& solved) {
  const Eigen::Index dimension = solved.control_points.rows();
  const Eigen::VectorXd move =
      task.middle + (task.ordered.cloud.origin() - task.options.shift).head(dimension);
  return MovedTerms(
      task.options.terms(solved.problem.basis_u(), solved.control_points.colwise() + move), move);
}

// Keeps the result unless it leaves the ends of the points or, where no terms of the user lead away
// from them, overshoots or grows far beyond them.
template <int Dim>
void Adopt(const CurveTask& task,
           OptimizeResult&& result,
           SolvedCurve& solved,
           OptimizeSummary& summary) {
  summary.ran = result.ran;
  summary.iterations = result.iterations;
  summary.rms_before = result.rms_before;
  summary.rms_after = result.rms_after;
  if (!result.note.empty())
    summary.why = result.ran ? summary.why + "; " + result.note : result.note;
  solved.rounds.insert(solved.rounds.end(), result.rounds.begin(), result.rounds.end());
  if (result.cancelled) solved.end = EndCode::kCancelled;
  const NurbsCurve<Dim> curve(
      result.problem.basis_u(), std::move(result.control_points), std::move(result.weights));
  const bool terms = static_cast<bool>(task.options.terms);
  const bool bounded =
      terms || !HasOvershoot(result.problem, curve.control_points(), curve.weights(), task.noise) ||
      HasOvershoot(solved.problem, solved.control_points, solved.weights, task.noise);
  const double before =
      SampledSize(solved.problem.basis_u(), solved.control_points, solved.weights);
  const double after = SampledSize(curve.basis(), curve.control_points(), curve.weights());
  const auto take = [&](FittingProblem problem, const NurbsCurve<Dim>& found) {
    solved.problem = std::move(problem);
    solved.control_points = found.control_points();
    solved.weights = found.weights();
  };
  if (!bounded || (!terms && after > kLargest * std::max(task.size, before))) {
    summary.why += "; not taken, as it left the points between them";
    summary.rms_after = summary.rms_before;
  } else if (!task.by_feet() || terms) {  // a cut would move the control points that terms name
    take(std::move(result.problem), curve);
  } else if (auto cut = CutToData(curve, result.problem.data())) {
    take(result.problem.WithBasis(cut->curve.basis()).WithParameters(cut->parameters), cut->curve);
  } else {
    summary.why += "; not taken, as it left the ends of the points";
    summary.rms_after = summary.rms_before;
  }
}

// Tries few rational spans where weights are free.
std::optional<OptimizeResult> FewRationalSpans(const CurveTask& task, const SolvedCurve& solved) {
  const CurveFitOptions& options = task.options;
  if (!options.optimize || !options.optimize->weights || options.control_points || options.terms)
    return {};
  RationalSpansOptions rational;
  rational.optimize.free = *options.optimize;
  rational.optimize.free.knots = false;  // a search of its own for each number of spans
  const Eigen::VectorXd distances = task.DistancesOf(solved.problem, solved.control_points);
  SetUp(task, solved.problem, distances, rational.optimize);
  rational.goal = std::max(task.near_exact ? 0 : task.noise, Rounding(task));
  rational.tolerance = options.tolerance;
  // Where the spans at hand do already, rational ones pay with half as many.
  const double rms = std::sqrt(distances.squaredNorm() / static_cast<double>(distances.size()));
  const int unknowns = solved.problem.unknowns();
  const bool at_goal = rms <= std::max(kExcessToOptimise * NoiseLeft(task), Rounding(task));
  rational.most_control_points = at_goal ? options.degree + unknowns / 2 : unknowns;
  const SplineBasis& basis = solved.problem.basis_u();
  const SpanLayout start = SpanLayout::Equal(options.degree,
                                             1 + static_cast<int>(task.corners.size()),
                                             basis.lower(),
                                             basis.upper(),
                                             task.corners,
                                             task.ordered.closed);
  // Parameters as they came: feet on many spans are not those of few.
  Eigen::Matrix2Xd parameters = solved.problem.data().parameters;
  parameters.row(0) = task.given;
  return FewestRationalSpans(
      solved.problem.WithParameters(std::move(parameters)), start, rational, task.pool);
}

// Whether the joint stage runs by itself, and what it frees; says why.
bool Pays(const CurveTask& task,
          const SolvedCurve& solved,
          const Eigen::VectorXd& distances,
          double rms,
          FreeVariables& free,
          std::string& why) {
  const CurveFitOptions& options = task.options;
  const bool held = !task.by_feet();
  free = {.parameters = !held, .knots = held};
  if (held && solved.problem.basis_u().periodic()) {
    why = "the knots of a closed curve are not free";
    return false;
  }
  if (options.tolerance && distances.maxCoeff() <= *options.tolerance) {
    why = "the tolerance is kept";
    return false;
  }
  if (!options.tolerance && rms <= std::max(kExcessToOptimise * NoiseLeft(task), Rounding(task))) {
    why = "residuals are at the noise";
    return false;
  }
  const double enough =
      options.tolerance ? kPointsPerFreedomForTolerance : kPointsPerFreedomToOptimise;
  if (static_cast<double>(solved.problem.size()) < enough * solved.problem.unknowns()) {
    why = "residuals exceed the noise, but the points are too few for more freedom";
    return false;
  }
  why = "residuals exceed the noise";
  return true;
}

}  // namespace

template <int Dim>
void ImproveJointly(CurveTask& task,
                    SolvedCurve& solved,
                    StageClock& clock,
                    OptimizeSummary& summary) {
  const CurveFitOptions& options = task.options;
  clock.Enter(&StageSeconds::optimize);
  if (std::optional<OptimizeResult> few = FewRationalSpans(task, solved)) {
    summary.why = "asked for; fewer spans do with weights";
    return Adopt<Dim>(task, std::move(*few), solved, summary);
  }
  // Of many points the squares of the solution say as much, at once.
  const auto points = static_cast<double>(solved.problem.size());
  const bool many = solved.problem.size() > kManyCurvePoints && !options.optimize &&
                    !options.tolerance && !options.terms;
  const double before = std::sqrt(solved.squares / points);
  if (many && before <= kExcessToOptimise * NoiseLeft(task)) {
    summary.rms_before = summary.rms_after = before;
    summary.why = "residuals are at the noise";
    return;
  }
  clock.Enter(&StageSeconds::project);
  const Eigen::VectorXd distances = task.DistancesOf(solved.problem, solved.control_points);
  const double rms = std::sqrt(distances.squaredNorm() / static_cast<double>(distances.size()));
  summary.rms_before = summary.rms_after = rms;
  clock.Enter(&StageSeconds::optimize);
  if (solved.end == EndCode::kCancelled) return;
  OptimizeOptions optimize;
  if (options.terms) {
    optimize.free = options.optimize.value_or(FreeVariables{.parameters = task.by_feet()});
    summary.why = "the user's terms ask for it";
  } else if (options.optimize) {
    optimize.free = *options.optimize;
    summary.why = optimize.free.any() ? "asked for" : "not asked for";
    if (!optimize.free.any()) return;
  } else if (!Pays(task, solved, distances, rms, optimize.free, summary.why)) {
    return;
  }
  if (solved.problem.size() < solved.problem.unknowns() && !options.terms) {
    summary.why = "there are fewer points than control points";
    return;
  }
  if (optimize.free.parameters) task.distance = CurveDistance::kPoint;
  SetUp(task, solved.problem, distances, optimize);
  if (options.terms) {
    optimize.terms = TermsOf(task, solved);
    optimize.stop_at_noise = false;
  }
  Adopt<Dim>(task,
             Optimize(solved.problem, solved.control_points, solved.weights, optimize, task.pool),
             solved,
             summary);
}

template void ImproveJointly<2>(CurveTask&, SolvedCurve&, StageClock&, OptimizeSummary&);
template void ImproveJointly<3>(CurveTask&, SolvedCurve&, StageClock&, OptimizeSummary&);

}  // namespace batten::internal
