// SPDX-License-Identifier: MIT
#include "batten/fitting/optimize.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "batten/fitting/free_knots.h"
#include "batten/fitting/solve_linear.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/split.h"
#include "fitting/joint/harmonic_reparameterization.h"
#include "fitting/joint/joint_optimization.h"
#include "fitting/joint/smooth_parameters.h"
#include "fitting/knots/knot_gaps.h"
#include "geometry/numeric/reject.h"

namespace batten {
using namespace internal;
namespace {

constexpr int kSettlingSteps = 10;    // of points and parameters before all are free
constexpr double kCoalesced = 1e-6;   // of the domain
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

// One optimisation, stage by stage; members are what the stages hand on.
class Optimizer {
 public:
  Optimizer(const FittingProblem& problem,
            const Eigen::MatrixXd& control_points,
            const Eigen::VectorXd& weights,
            const OptimizeOptions& options,
            ThreadPool& pool)
      : options_(options),
        pool_(pool),
        fairness_(options.fairness),
        result_{problem, control_points, weights, 0, 0, 0, false, false, "", {}} {
    if (weights.size() == 0) result_.weights = Eigen::VectorXd::Ones(control_points.cols());
  }

  OptimizeResult Run() {
    Start();
    if (at_noise_ || !(options_.free.any() || !options_.terms.empty())) return std::move(result_);
    result_.ran = true;
    if (options_.free.parameters) SpreadOverSteepParts();
    if (options_.free.parameters) SmoothRoughParameters();
    if (options_.free.knots) SearchKnots();
    const bool more = options_.free.weights || options_.free.knots;
    if (options_.free.weights && options_.free.parameters) Widen();
    if (more && options_.free.parameters && HasInteriorKnots(result_.problem)) {
      Joint({.parameters = true}, kSettlingSteps, options_.least_gain);
    }
    if (options_.free.weights) {
      WithWeights();
    } else if (options_.free.parameters || !options_.terms.empty() ||
               (options_.free.knots && !Linear())) {
      Joint(options_.free, options_.max_iterations, more ? kFinestGain : options_.least_gain);
    }
    if (options_.free.knots) Coalesce();
    if (narrow_) Narrow();
    return std::move(result_);
  }

 private:
  // Measures the given shape, and whether its residuals are at the noise level.
  void Start() {
    JointOptions probe = Settings({.parameters = options_.free.parameters});
    probe.max_iterations = 0;
    // A shape that fits already is not worth a start: all that could be gained is noise.
    const auto points = static_cast<double>(std::max<Eigen::Index>(1, result_.problem.size()));
    probe.noise_slack = kSlack + kSlackOfFew / std::sqrt(points) +
                        kSlackOfFairness * result_.problem.unknowns() / points;
    const JointResult start =
        OptimizeJointly(result_.problem, result_.control_points, result_.weights, probe, pool_);
    result_.rms_before = result_.rms_after = start.rms_after;
    misfit_ = start.misfit_after;
    at_noise_ = start.at_noise || !start.note.empty();  // or no start at all
    result_.note = start.note;
  }

  JointOptions Settings(const FreeVariables& free) const {
    JointOptions joint;
    joint.orthogonal = options_.free.parameters;
    joint.free_weights = free.weights;
    joint.free_knots_u = free.knots && options_.knots_u;
    joint.free_knots_v = free.knots && options_.knots_v;
    joint.fixed_control_points = options_.fixed_control_points;
    joint.held = options_.held;
    joint.terms = options_.terms;
    joint.stop_at_noise = options_.stop_at_noise;
    joint.noise = options_.noise;
    joint.noise_slack = -kMarginOfNoise;
    joint.loss = options_.loss;
    joint.loss_scale = options_.loss_scale;
    joint.fairness = fairness_;
    joint.seconds = options_.seconds > 0 ? std::max(1e-3, options_.seconds - Elapsed()) : 0;
    joint.progress = options_.progress;
    return joint;
  }

  double Elapsed() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }
  bool Over() const {
    return result_.cancelled || at_noise_ ||
           (options_.seconds > 0 && Elapsed() >= options_.seconds);
  }
  double Size() const { return Size(result_.control_points); }
  static double Size(const Eigen::MatrixXd& points) {
    return (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
  }
  bool Plain() const {  // the sum that is minimised is that of the squared distances
    return options_.loss == Loss::kNone && options_.terms.empty();
  }

  void Adopt(JointResult&& joint) {
    result_.iterations += joint.iterations;
    result_.rounds.insert(result_.rounds.end(), joint.rounds.begin(), joint.rounds.end());
    result_.cancelled = result_.cancelled || joint.cancelled;
    if (!joint.note.empty()) result_.note = joint.note;
    if (Plain() ? joint.rms_after > result_.rms_after : !(joint.misfit_after <= misfit_)) return;
    misfit_ = joint.misfit_after;
    result_.problem = std::move(joint.problem);
    result_.control_points = std::move(joint.control_points);
    result_.weights = std::move(joint.weights);
    result_.rms_after = joint.rms_after;
  }

  void Joint(const FreeVariables& free, int steps, double least_gain) {
    if (Over()) return;
    JointOptions joint = Settings(free);
    joint.max_iterations = steps;
    joint.least_gain = least_gain;
    joint.size = Size();
    JointResult found =
        OptimizeJointly(result_.problem, result_.control_points, result_.weights, joint, pool_);
    at_noise_ = found.at_noise;
    Adopt(std::move(found));
  }

  // Most shapes settle soon with the usual fairness; what does not, because fairness keeps it from
  // the weights it needs, gets a long run with next to none.
  void WithWeights() {
    const OptimizeResult start = result_;
    const double start_misfit = misfit_;
    Joint(options_.free, kQuickSteps, kFinestGain);
    if (Over() || Exact()) return;
    OptimizeResult quick = std::move(result_);
    const double quick_misfit = std::exchange(misfit_, start_misfit);
    result_ = start;
    result_.iterations = quick.iterations;
    result_.rounds = quick.rounds;
    fairness_ = std::min(options_.fairness, kFaintFairness);
    Joint(options_.free, kValleySteps - kQuickSteps, kFinestGain);
    if (Plain() ? result_.rms_after > quick.rms_after : misfit_ > quick_misfit) {
      misfit_ = quick_misfit;
      quick.iterations = result_.iterations;
      quick.cancelled = result_.cancelled;
      quick.rounds = result_.rounds;
      result_ = std::move(quick);
    }
  }

  bool Exact() const { return result_.rms_after <= kExact * Size(); }

  // Takes the linear solution of another problem (of other bases, parameters or weights) where it
  // is nearer to the data, which keep their own weights.
  void TryLinear(const FittingProblem& other) {
    if (other.size() < other.unknowns()) return;
    const Eigen::MatrixXd net = SolveLinear(other, pool_).coefficients;
    const FittingProblem problem = other.WithWeights(result_.problem.data().weights);
    JointOptions probe = Settings({.parameters = options_.free.parameters});
    probe.max_iterations = 0;
    JointResult found = OptimizeJointly(problem, net, {}, probe, pool_);
    at_noise_ = found.rms_after < result_.rms_after && found.at_noise;
    Adopt(std::move(found));
  }

  bool Linear() const {  // the shape is what a linear solution can find
    return options_.fixed_control_points.empty() && options_.terms.empty() &&
           (result_.weights.array() == result_.weights[0]).all() && !Periodic(result_.problem);
  }

  void SmoothRoughParameters() {
    if (Over() || result_.problem.is_curve() || !Linear()) return;  // coarse curves don't settle
    if (!ScatterOf(result_.problem, result_.control_points, pool_).rough()) return;
    const SmoothedParameters smooth = WithSmoothParameters(
        result_.problem, options_.loss, options_.loss_scale, pool_, options_.progress);
    result_.iterations += smooth.iterations;
    TryLinear(smooth.problem);
  }

  // While weights move, the speed of the parameters along the shape does, and foot points run into
  // the domain's ends. So the shape is made larger than the data, until it has settled.
  void Widen() {
    if (Over() || !Linear()) return;
    const FittingProblem& problem = result_.problem;
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
    if (wider.size() < wider.unknowns()) return;
    narrow_ = std::make_unique<OptimizeResult>(result_);
    result_.problem = wider;
    result_.control_points = SolveLinear(wider, pool_).coefficients;
    JointOptions probe = Settings({.parameters = true});
    probe.max_iterations = 0;
    const JointResult start =
        OptimizeJointly(result_.problem, result_.control_points, {}, probe, pool_);
    result_.rms_after = start.rms_after;
    narrow_misfit_ = std::exchange(misfit_, start.misfit_after);
  }

  // Cut back to where the foot points are, but never past a knot.
  void Narrow() {
    const FittingProblem& problem = result_.problem;
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
    OptimizeResult cut = result_;
    const auto [a, b] = range(problem.basis_u(), 0);
    if (problem.is_curve()) {
      if (cut.control_points.rows() == 2) {
        Cut(Segment(NurbsCurve<2>(problem.basis_u(), cut.control_points, cut.weights), a, b), cut);
      } else {
        Cut(Segment(NurbsCurve<3>(problem.basis_u(), cut.control_points, cut.weights), a, b), cut);
      }
    } else {
      const auto [c, d] = range(problem.basis_v(), 1);
      const NurbsSurface surface = Segment(
          NurbsSurface(problem.basis_u(), problem.basis_v(), cut.control_points, cut.weights),
          a,
          b,
          c,
          d);
      cut.control_points = surface.control_points();
      cut.weights = surface.weights();
      cut.problem = problem.WithBases(surface.basis_u(), surface.basis_v());
    }
    cut.weights /= std::exp(cut.weights.array().log().mean());
    JointOptions probe = Settings({.parameters = true});
    probe.max_iterations = 0;
    const JointResult measured =
        OptimizeJointly(cut.problem, cut.control_points, cut.weights, probe, pool_);
    cut.rms_after = measured.rms_after;
    // Beside it the shape without weights. The record is that of both.
    cut.cancelled = result_.cancelled;
    result_.problem = narrow_->problem;
    result_.control_points = narrow_->control_points;
    result_.weights = narrow_->weights;
    result_.rms_after = narrow_->rms_after;
    misfit_ = narrow_misfit_;
    if (!cut.cancelled && cut.rms_after > kExact * Size(cut.control_points)) {
      at_noise_ = false;
      fairness_ = options_.fairness;
      Joint({.parameters = true}, options_.max_iterations, options_.least_gain);
    }
    if (!WeightsPay(cut, measured.misfit_after)) return;
    misfit_ = measured.misfit_after;
    cut.iterations = result_.iterations;
    cut.rounds = result_.rounds;
    cut.cancelled = result_.cancelled;
    result_ = std::move(cut);
  }

  // Whether weights explain clearly more than as many free numbers explain of noise, and have not
  // let the net run along the shape, far out of the data. [Schwarz 1978]
  bool WeightsPay(const OptimizeResult& with, double misfit) const {
    if (Size(with.control_points) > kLargestNet * Size(with.problem.data().values)) return false;
    const auto points = static_cast<double>(with.problem.size());
    const auto numbers = static_cast<double>(with.weights.size());
    const double left = Plain() ? points * with.rms_after * with.rms_after : misfit;
    const double gain = (Plain() ? points * result_.rms_after * result_.rms_after : misfit_) - left;
    const double noise = left / std::max(1.0, points - numbers);
    return gain > std::log(points) * numbers * noise;
  }

  template <int Dim>
  static void Cut(const NurbsCurve<Dim>& curve, OptimizeResult& result) {
    result.control_points = curve.control_points();
    result.weights = curve.weights();
    result.problem = result.problem.WithBasis(curve.basis());
  }

  // A surface that its parameters stretch unevenly, as walls seen from above, has its control
  // points in the wrong places: more even parameters are tried, on a finer shape of the same data.
  void SpreadOverSteepParts() {
    const FittingProblem& given = result_.problem;
    if (Over() || given.is_curve() || !Linear()) return;
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
    Eigen::MatrixXd net = SolveLinear(fine, pool_).coefficients;
    for (int round = 0; round < kSpreadings; ++round) {
      const NurbsSurface surface(fine.basis_u(), fine.basis_v(), net);
      const ReparameterizeHarmonically spread(surface, pool_);
      if (round == 0 && spread.unevenness() < kUneven) return;
      fine = fine.WithParameters(spread(fine.data().parameters));
      net = SolveLinear(fine, pool_).coefficients;
    }
    const FittingProblem even = given.WithParameters(fine.data().parameters);
    TryLinear(even);
  }

  void SearchKnots() {
    if (Over() || !Linear()) return;
    FreeKnotOptions knots;
    knots.u = options_.knots_u;
    knots.v = options_.knots_v;
    knots.seed = options_.seed;
    if (result_.problem.unknowns() > kManyForKnots) {
      knots.starts = kFewStarts;
      knots.max_iterations = kShortDescent;
    }
    knots.seconds = options_.seconds > 0 ? std::max(1e-3, options_.seconds - Elapsed()) : 0;
    knots.progress = options_.progress;
    const FreeKnotResult found = OptimizeKnots(Reweighted(), knots, pool_);
    result_.iterations += found.iterations;
    result_.cancelled = result_.cancelled || found.cancelled;
    if (!found.note.empty()) result_.note = found.note;
    if (found.squares_after < found.squares_before) TryLinear(found.problem);
  }

  // The problem with the weights that the loss gives its data at the present shape.
  FittingProblem Reweighted() const {
    const FittingProblem& problem = result_.problem;
    if (options_.loss == Loss::kNone) return problem;
    const Eigen::VectorXd distances =
        (EvaluateAt(problem, result_.control_points, pool_) - problem.data().values)
            .colwise()
            .norm();
    Eigen::VectorXd weights = LossWeights(options_.loss, distances, options_.loss_scale);
    if (problem.data().weights.size() > 0) weights.array() *= problem.data().weights.array();
    return problem.WithWeights(std::move(weights));
  }

  // Knots nearer than rounding of the domain become one, and the rest settles again.
  void Coalesce() {
    if (Over() || !(options_.free.parameters || options_.free.weights)) return;
    const auto merged = [&](const SplineBasis& basis, bool free) {
      if (!free || basis.periodic()) return basis;
      const KnotGaps gaps(basis);
      return gaps.Coalesced(kCoalesced * gaps.length()).basis();
    };
    const FittingProblem& problem = result_.problem;
    const SplineBasis u = merged(problem.basis_u(), options_.knots_u);
    const FittingProblem together =
        problem.is_curve() ? problem.WithBasis(u)
                           : problem.WithBases(u, merged(problem.basis_v(), options_.knots_v));
    if (u == problem.basis_u() && (problem.is_curve() || together.basis_v() == problem.basis_v())) {
      return;
    }
    JointOptions joint = Settings(options_.free);
    joint.max_iterations = options_.max_iterations;
    Adopt(OptimizeJointly(together, result_.control_points, result_.weights, joint, pool_));
  }

  const OptimizeOptions& options_;
  ThreadPool& pool_;
  double fairness_;
  OptimizeResult result_;
  double misfit_ = 0, narrow_misfit_ = 0;   // what is minimised with a loss or terms
  std::unique_ptr<OptimizeResult> narrow_;  // what there was before the shape was made larger
  bool at_noise_ = false;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

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
  return Optimizer(problem, control_points, weights, options, pool).Run();
}

}  // namespace batten
