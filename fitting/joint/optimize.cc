// SPDX-License-Identifier: MIT
#include "batten/fitting/optimize.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "batten/fitting/free_knots.h"
#include "batten/fitting/solve_linear.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/split.h"
#include "fitting/core/stopwatch.h"
#include "fitting/joint/harmonic_reparameterization.h"
#include "fitting/joint/joint_optimization.h"
#include "fitting/joint/smooth_parameters.h"
#include "fitting/knots/knot_gaps.h"
#include "geometry/numeric/box_diagonal.h"
#include "geometry/numeric/reject.h"

namespace batten {
using namespace internal;
namespace {

constexpr int kSettlingSteps = 10;    // of points and parameters before all are free
constexpr double kFinestGain = 1e-9;  // relative, with free weights or knots: convergence is slow
constexpr int kValleySteps = 300;
constexpr int kQuickSteps = 40;
constexpr double kFaintFairness = 1e-9;
constexpr double kExact = 5e-9;  // of the size
constexpr int kManyForKnots = 200, kFewStarts = 2, kShortDescent = 40;
constexpr double kLargestNet = 2;  // against the data
constexpr double kUneven = 4;      // stretch that calls for other parameters
constexpr int kSpreadings = 2;
constexpr double kMarginOfNoise = 0.001;  // what neighbours share is counted as noise
constexpr double kSlack = 0.03;           // of the squares: bias that is worth no start,
constexpr double kSlackOfFew = 1.5;       // the error of the estimate, by the root of the points,
constexpr double kSlackOfFairness = 0.5;  // and what fairness takes of each control point
constexpr double kMargin = 0.05;          // share of the domain by which the shape exceeds the data
constexpr double kLeastEnd = 0.95;        // of an end span: further in it is not cut

bool HasInteriorKnots(const FittingProblem& problem) {
  return problem.basis_u().Spans().size() > 1 ||
         (!problem.is_curve() && problem.basis_v().Spans().size() > 1);
}

bool Periodic(const FittingProblem& problem) {
  return problem.basis_u().periodic() || (!problem.is_curve() && problem.basis_v().periodic());
}

// What all stages read.
struct Run {
  const OptimizeOptions& options;
  ThreadPool& pool;
  Stopwatch clock = {};

  double SecondsLeft() const {
    return options.seconds > 0 ? std::max(1e-3, options.seconds - clock.Seconds()) : 0;
  }
  bool Plain() const {  // the sum that is minimised is that of the squared distances
    return options.loss == Loss::kNone && options.terms.empty();
  }
};

// What the stages hand on: the shape so far with the record of what led to it.
struct State {
  OptimizeResult result;
  double fairness;
  double misfit = 0;  // what is minimised with a loss or terms
  bool at_noise = false;
};

bool Over(const Run& run, const State& state) {
  return state.result.cancelled || state.at_noise ||
         (run.options.seconds > 0 && run.clock.Seconds() >= run.options.seconds);
}

bool IsExact(const OptimizeResult& result) {
  return result.rms_after <= kExact * BoxDiagonal(result.control_points);
}

// Whether the shape is what a linear solution can find.
bool IsLinear(const Run& run, const OptimizeResult& result) {
  return run.options.fixed_control_points.empty() && run.options.terms.empty() &&
         (result.weights.array() == result.weights[0]).all() && !Periodic(result.problem);
}

JointOptions Settings(const Run& run, const State& state, const FreeVariables& free) {
  const OptimizeOptions& options = run.options;
  JointOptions joint;
  joint.orthogonal = options.free.parameters;
  joint.free_weights = free.weights;
  joint.free_knots_u = free.knots && options.knots_u;
  joint.free_knots_v = free.knots && options.knots_v;
  joint.fixed_control_points = options.fixed_control_points;
  joint.held = options.held;
  joint.terms = options.terms;
  joint.stop_at_noise = options.stop_at_noise;
  joint.noise = options.noise;
  joint.noise_slack = -kMarginOfNoise;
  joint.loss = options.loss;
  joint.loss_scale = options.loss_scale;
  joint.fairness = state.fairness;
  joint.seconds = run.SecondsLeft();
  joint.progress = options.progress;
  return joint;
}

// A shape as it is; with `slack` more, in shares of the squares, it counts as at the noise.
JointResult Measured(const Run& run,
                     const State& state,
                     const OptimizeResult& shape,
                     std::optional<double> slack = std::nullopt) {
  JointOptions probe = Settings(run, state, {.parameters = run.options.free.parameters});
  probe.max_iterations = 0;
  if (slack) probe.noise_slack = *slack;
  return OptimizeJointly(shape.problem, shape.control_points, shape.weights, probe, run.pool);
}

// The given shape, and whether its residuals are at the noise level.
State Start(const Run& run, OptimizeResult given) {
  State state{std::move(given), run.options.fairness};
  OptimizeResult& result = state.result;
  if (result.weights.size() == 0)
    result.weights = Eigen::VectorXd::Ones(result.control_points.cols());
  // A shape that fits already is not worth a start: all that could be gained is noise.
  const auto points = static_cast<double>(std::max<Eigen::Index>(1, result.problem.size()));
  const JointResult start = Measured(run,
                                     state,
                                     result,
                                     kSlack + kSlackOfFew / std::sqrt(points) +
                                         kSlackOfFairness * result.problem.unknowns() / points);
  result.rms_before = result.rms_after = start.rms_after;
  state.misfit = start.misfit_after;
  state.at_noise = start.at_noise || !start.note.empty();  // or no start at all
  result.note = start.note;
  return state;
}

// Takes what a step found unless it is farther from the data, and its record in any case.
void Adopt(const Run& run, JointResult&& joint, State& state) {
  OptimizeResult& result = state.result;
  result.iterations += joint.iterations;
  result.rounds.insert(result.rounds.end(), joint.rounds.begin(), joint.rounds.end());
  result.cancelled = result.cancelled || joint.cancelled;
  if (!joint.note.empty()) result.note = joint.note;
  if (run.Plain() ? joint.rms_after > result.rms_after : !(joint.misfit_after <= state.misfit))
    return;
  state.misfit = joint.misfit_after;
  result.problem = std::move(joint.problem);
  result.control_points = std::move(joint.control_points);
  result.weights = std::move(joint.weights);
  result.rms_after = joint.rms_after;
}

void Joint(const Run& run, const FreeVariables& free, int steps, double least_gain, State& state) {
  if (Over(run, state)) return;
  const OptimizeResult& from = state.result;
  JointOptions joint = Settings(run, state, free);
  joint.max_iterations = steps;
  joint.least_gain = least_gain;
  joint.size = BoxDiagonal(from.control_points);
  JointResult found =
      OptimizeJointly(from.problem, from.control_points, from.weights, joint, run.pool);
  state.at_noise = found.at_noise;
  Adopt(run, std::move(found), state);
}

// Most shapes settle soon with the usual fairness; what does not, because fairness keeps it from
// the weights it needs, gets a long run with next to none.
void WithWeights(const Run& run, State& state) {
  const State start = state;
  const FreeVariables& free = run.options.free;
  Joint(run, free, kQuickSteps, kFinestGain, state);
  if (Over(run, state) || IsExact(state.result)) return;
  State quick = std::exchange(state, start);
  state.result.iterations = quick.result.iterations;
  state.result.rounds = quick.result.rounds;
  state.fairness = std::min(run.options.fairness, kFaintFairness);
  Joint(run, free, kValleySteps - kQuickSteps, kFinestGain, state);
  const bool worse =
      run.Plain() ? state.result.rms_after > quick.result.rms_after : state.misfit > quick.misfit;
  if (!worse) return;
  quick.result.iterations = state.result.iterations;
  quick.result.cancelled = state.result.cancelled;
  quick.result.rounds = std::move(state.result.rounds);
  state.misfit = quick.misfit;
  state.result = std::move(quick.result);
}

// Takes the linear solution of another problem (of other bases, parameters or weights) where it is
// nearer to the data, which keep their own weights.
void TryLinear(const Run& run, const FittingProblem& other, State& state) {
  if (other.size() < other.unknowns()) return;
  OptimizeResult linear = state.result;
  linear.control_points = SolveLinear(other, run.pool).coefficients;
  linear.problem = other.WithWeights(state.result.problem.data().weights);
  linear.weights.resize(0);
  JointResult found = Measured(run, state, linear);
  state.at_noise = found.rms_after < state.result.rms_after && found.at_noise;
  Adopt(run, std::move(found), state);
}

// A surface that its parameters stretch unevenly, as walls seen from above, has its control points
// in the wrong places: more even parameters are tried, on a finer shape of the same data.
void SpreadOverSteepParts(const Run& run, State& state) {
  const FittingProblem& given = state.result.problem;
  if (Over(run, state) || given.is_curve() || !IsLinear(run, state.result)) return;
  const auto finer = [&](const SplineBasis& basis, int share) {
    const int spans = static_cast<int>(basis.Spans().size());
    return SplineBasis::Uniform(basis.degree(),
                                basis.degree() + std::max(spans, std::min(2 * spans, share)),
                                basis.lower(),
                                basis.upper());
  };
  const int share = static_cast<int>(std::sqrt(static_cast<double>(given.size()) / 2));
  FittingProblem fine =
      given.WithBases(finer(given.basis_u(), share), finer(given.basis_v(), share));
  if (fine.size() < fine.unknowns()) return;
  Eigen::MatrixXd net = SolveLinear(fine, run.pool).coefficients;
  for (int round = 0; round < kSpreadings; ++round) {
    const NurbsSurface surface(fine.basis_u(), fine.basis_v(), net);
    const ReparameterizeHarmonically spread(surface, run.pool);
    if (round == 0 && spread.unevenness() < kUneven) return;
    fine = fine.WithParameters(spread(fine.data().parameters));
    net = SolveLinear(fine, run.pool).coefficients;
  }
  TryLinear(run, given.WithParameters(fine.data().parameters), state);
}

void SmoothRoughParameters(const Run& run, State& state) {
  const OptimizeResult& result = state.result;
  if (Over(run, state) || result.problem.is_curve() || !IsLinear(run, result))
    return;  // coarse curves don't settle
  if (!ScatterOf(result.problem, result.control_points, run.pool).rough()) return;
  const SmoothedParameters smooth = WithSmoothParameters(
      result.problem, run.options.loss, run.options.loss_scale, run.pool, run.options.progress);
  state.result.iterations += smooth.iterations;
  TryLinear(run, smooth.problem, state);
}

// The problem with the weights that the loss gives its data at the present shape.
FittingProblem WithLossWeights(const Run& run, const OptimizeResult& result) {
  const FittingProblem& problem = result.problem;
  if (run.options.loss == Loss::kNone) return problem;
  const Eigen::VectorXd distances =
      (EvaluateAt(problem, result.control_points, run.pool) - problem.data().values)
          .colwise()
          .norm();
  Eigen::VectorXd weights = LossWeights(run.options.loss, distances, run.options.loss_scale);
  if (problem.data().weights.size() > 0) weights.array() *= problem.data().weights.array();
  return problem.WithWeights(std::move(weights));
}

void SearchKnots(const Run& run, State& state) {
  OptimizeResult& result = state.result;
  if (Over(run, state) || !IsLinear(run, result)) return;
  FreeKnotOptions knots;
  knots.u = run.options.knots_u;
  knots.v = run.options.knots_v;
  knots.seed = run.options.seed;
  if (result.problem.unknowns() > kManyForKnots) {
    knots.starts = kFewStarts;
    knots.max_iterations = kShortDescent;
  }
  knots.seconds = run.SecondsLeft();
  knots.progress = run.options.progress;
  const FreeKnotResult found = OptimizeKnots(WithLossWeights(run, result), knots, run.pool);
  result.iterations += found.iterations;
  result.cancelled = result.cancelled || found.cancelled;
  if (!found.note.empty()) result.note = found.note;
  if (found.squares_after < found.squares_before) TryLinear(run, found.problem, state);
}

// Knots nearer than rounding of the domain become one, and the rest settles again.
void Coalesce(const Run& run, State& state) {
  const OptimizeOptions& options = run.options;
  if (Over(run, state) || !(options.free.parameters || options.free.weights)) return;
  const auto merged = [&](const SplineBasis& basis, bool free) {
    if (!free || basis.periodic()) return basis;
    const KnotGaps gaps(basis);
    return gaps.Coalesced(FreeKnotOptions().coalesce * gaps.length()).basis();
  };
  const OptimizeResult& from = state.result;
  const FittingProblem& problem = from.problem;
  const SplineBasis u = merged(problem.basis_u(), options.knots_u);
  const FittingProblem together =
      problem.is_curve() ? problem.WithBasis(u)
                         : problem.WithBases(u, merged(problem.basis_v(), options.knots_v));
  if (u == problem.basis_u() && (problem.is_curve() || together.basis_v() == problem.basis_v()))
    return;
  JointOptions joint = Settings(run, state, options.free);
  joint.max_iterations = options.max_iterations;
  Adopt(run, OptimizeJointly(together, from.control_points, from.weights, joint, run.pool), state);
}

// While weights move, the speed of the parameters along the shape does, and foot points run into
// the domain's ends. So the shape is made larger than the data, until it has settled. Returns the
// state before, where that is done.
std::optional<State> Widen(const Run& run, State& state) {
  if (Over(run, state) || !IsLinear(run, state.result)) return std::nullopt;
  const FittingProblem& problem = state.result.problem;
  const auto wide = [](const SplineBasis& basis) {
    std::vector<double> knots = basis.knots();
    const double margin = kMargin * (basis.upper() - basis.lower());
    for (double& t : knots) {
      if (t <= basis.lower()) t -= margin;
      if (t >= basis.upper()) t += margin;
    }
    return SplineBasis(basis.degree(), std::move(knots));
  };
  const FittingProblem wider =
      problem.is_curve() ? problem.WithBasis(wide(problem.basis_u()))
                         : problem.WithBases(wide(problem.basis_u()), wide(problem.basis_v()));
  if (wider.size() < wider.unknowns()) return std::nullopt;
  State narrow = state;
  state.result.problem = wider;
  state.result.control_points = SolveLinear(wider, run.pool).coefficients;
  OptimizeResult plain = state.result;
  plain.weights.resize(0);
  const JointResult start = Measured(run, state, plain);
  state.result.rms_after = start.rms_after;
  state.misfit = start.misfit_after;
  return narrow;
}

template <int Dim>
void Cut(const NurbsCurve<Dim>& curve, OptimizeResult& result) {
  result.control_points = curve.control_points();
  result.weights = curve.weights();
  result.problem = result.problem.WithBasis(curve.basis());
}

// The shape cut back to where the foot points are, but never past a knot.
OptimizeResult CutToFeet(OptimizeResult cut) {
  const FittingProblem problem = cut.problem;
  const auto range = [&](const SplineBasis& basis, int row) {
    const std::vector<int> spans = basis.Spans();
    const auto feet = problem.data().parameters.row(row);
    const double first = basis.knots()[spans.front() + 1], last = basis.knots()[spans.back()];
    double a = feet.minCoeff(), b = feet.maxCoeff();
    if (spans.size() > 1) {
      a = std::min(a, basis.lower() + kLeastEnd * (first - basis.lower()));
      b = std::max(b, basis.upper() - kLeastEnd * (basis.upper() - last));
    }
    return std::pair(a, b);
  };
  const auto [a, b] = range(problem.basis_u(), 0);
  if (!problem.is_curve()) {
    const auto [c, d] = range(problem.basis_v(), 1);
    const NurbsSurface surface =
        Segment(NurbsSurface(problem.basis_u(), problem.basis_v(), cut.control_points, cut.weights),
                a,
                b,
                c,
                d);
    cut.control_points = surface.control_points();
    cut.weights = surface.weights();
    cut.problem = problem.WithBases(surface.basis_u(), surface.basis_v());
  } else if (cut.control_points.rows() == 2) {
    Cut(Segment(NurbsCurve<2>(problem.basis_u(), cut.control_points, cut.weights), a, b), cut);
  } else {
    Cut(Segment(NurbsCurve<3>(problem.basis_u(), cut.control_points, cut.weights), a, b), cut);
  }
  cut.weights /= std::exp(cut.weights.array().log().mean());
  return cut;
}

// Whether weights explain clearly more than as many free numbers explain of noise, and have not let
// the net run along the shape, far out of the data. [Schwarz 1978]
bool WeightsPay(const Run& run, const State& with, const State& without) {
  const OptimizeResult& cut = with.result;
  if (BoxDiagonal(cut.control_points) > kLargestNet * BoxDiagonal(cut.problem.data().values))
    return false;
  const auto points = static_cast<double>(cut.problem.size());
  const auto numbers = static_cast<double>(cut.weights.size());
  const auto squares = [&](const State& state) {
    return run.Plain() ? points * state.result.rms_after * state.result.rms_after : state.misfit;
  };
  const double left = squares(with), gain = squares(without) - left;
  const double noise = left / std::max(1.0, points - numbers);
  return gain > std::log(points) * numbers * noise;
}

// The shape with weights, cut, or the one without them that it was widened from, settled, whichever
// the data are for. The record is that of both.
State Narrow(const Run& run, State narrow, const State& wide) {
  const OptimizeOptions& options = run.options;
  State cut = wide;
  cut.result = CutToFeet(std::move(cut.result));
  const JointResult measured = Measured(run, cut, cut.result);
  cut.result.rms_after = measured.rms_after;
  cut.misfit = measured.misfit_after;
  State plain = wide;
  plain.result.problem = std::move(narrow.result.problem);
  plain.result.control_points = std::move(narrow.result.control_points);
  plain.result.weights = std::move(narrow.result.weights);
  plain.result.rms_after = narrow.result.rms_after;
  plain.misfit = narrow.misfit;
  if (!cut.result.cancelled && !IsExact(cut.result)) {
    plain.at_noise = false;
    plain.fairness = options.fairness;
    Joint(run, {.parameters = true}, options.max_iterations, options.least_gain, plain);
  }
  if (!WeightsPay(run, cut, plain)) return plain;
  cut.result.iterations = plain.result.iterations;
  cut.result.rounds = std::move(plain.result.rounds);
  cut.result.cancelled = plain.result.cancelled;
  return cut;
}

OptimizeResult OptimizeByStages(const Run& run, OptimizeResult given) {
  const OptimizeOptions& options = run.options;
  const FreeVariables& free = options.free;
  State state = Start(run, std::move(given));
  if (state.at_noise || !(free.any() || !options.terms.empty())) return std::move(state.result);
  state.result.ran = true;
  if (free.parameters) SpreadOverSteepParts(run, state);
  if (free.parameters) SmoothRoughParameters(run, state);
  if (free.knots) SearchKnots(run, state);
  const bool more = free.weights || free.knots;
  std::optional<State> narrow;
  if (free.weights && free.parameters) narrow = Widen(run, state);
  if (more && free.parameters && HasInteriorKnots(state.result.problem))
    Joint(run, {.parameters = true}, kSettlingSteps, options.least_gain, state);
  if (free.weights) {
    WithWeights(run, state);
  } else if (free.parameters || !options.terms.empty() ||
             (free.knots && !IsLinear(run, state.result))) {
    Joint(run, free, options.max_iterations, more ? kFinestGain : options.least_gain, state);
  }
  if (free.knots) Coalesce(run, state);
  if (narrow) state = Narrow(run, *std::move(narrow), state);
  return std::move(state.result);
}

}  // namespace

void Check(const OptimizeOptions& options) {
  if (options.max_iterations < 1) Reject("OptimizeOptions", "max_iterations must be positive");
  if (!(options.noise >= 0) || !std::isfinite(options.noise))
    Reject("OptimizeOptions", "noise must not be negative");
  if (!(options.least_gain >= 0)) Reject("OptimizeOptions", "least_gain must not be negative");
  if (!(options.loss_scale > 0) || !std::isfinite(options.loss_scale))
    Reject("OptimizeOptions", "loss_scale must be positive");
  if (!(options.fairness >= 0) || !std::isfinite(options.fairness))
    Reject("OptimizeOptions", "fairness must not be negative");
  if (!(options.seconds >= 0)) Reject("OptimizeOptions", "seconds must not be negative");
}

OptimizeResult Optimize(const FittingProblem& problem,
                        const Eigen::MatrixXd& control_points,
                        const Eigen::VectorXd& weights,
                        const OptimizeOptions& options,
                        ThreadPool& pool) {
  Check(options);
  if (!options.held.empty() &&
      (problem.is_curve() || static_cast<Eigen::Index>(options.held.size()) != problem.size())) {
    Reject("OptimizeOptions", "held must be empty, or one for each point of a surface");
  }
  return OptimizeByStages({options, pool},
                          {problem, control_points, weights, 0, 0, 0, false, false, "", {}});
}

}  // namespace batten
