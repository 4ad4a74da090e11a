// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_curve.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "batten/fitting/distances.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/optimize.h"
#include "batten/fitting/reweighting.h"
#include "batten/fitting/stopwatch.h"

namespace batten {
namespace {

constexpr double kSmoothing = 1e-10;  // enough for gaps, too little to be seen elsewhere
constexpr int kBasisPasses = 2;       // weights choose spans, spans choose weights
constexpr double kExcessToSayNoise = 2;
constexpr double kExcessToOptimise = 1.1;  // residual against noise
constexpr double kPointsPerFreedomToOptimise = 3;
constexpr double kTiny = 1e-300;  // a scale must be positive, even of residuals that vanish
constexpr double kExact = 1e-9;   // of the cloud's size: rounding

// One fit, stage by stage; members are what the stages hand on.
template <int Dim>
class CurveFitter {
 public:
  CurveFitter(const PointCloud& cloud, const CurveFitOptions& options)
      : cloud_(cloud), options_(options), pool_(options.threads) {
    report_.threads = pool_.threads();
    distance_ = options.distance;
    if (distance_ == CurveDistance::kAuto) {
      distance_ = options.parameterization == CurveParameterization::kGiven
                      ? CurveDistance::kParameter
                      : CurveDistance::kPoint;
    }
  }

  CurveFit<Dim> Run() {
    Prepare();
    ChooseBasis();
    if (options_.tolerance) {
      Refine();
    } else {
      Solve();
    }
    OptimiseWhereItPays();
    return Measure();
  }

 private:
  void Prepare() {
    Report(options_.progress, "prepare", 0);
    ordered_ = OrderPoints(cloud_, options_.parameterization, options_.keep_order);
    auto data = std::make_shared<FittingData>();
    const Eigen::VectorXd& u = ordered_.parameters;
    data->parameters = Eigen::Matrix2Xd::Zero(2, u.size());
    data->parameters.row(0) = u;
    data->values = ordered_.cloud.points().template topRows<Dim>();
    middle_ = data->values.rowwise().mean();
    data->values.colwise() -= middle_;
    const Eigen::VectorXd& weights = ordered_.cloud.weights();
    if (weights.size() > 0) data->weights = weights / weights.mean();
    problem_ = FittingProblem(
        SplineBasis::Uniform(options_.degree, options_.degree + 1, u.minCoeff(), u.maxCoeff()),
        std::move(data),
        options_.smoothing.value_or(kSmoothing));
    InputSummary& input = report_.input;
    input.points = cloud_.size();
    input.duplicates = ordered_.repeats;
    input.spacing = ordered_.spacing;
    input.noise = ordered_.noise;
    input.origin = cloud_.origin();
    input.box_min = cloud_.origin() + cloud_.points().rowwise().minCoeff();
    input.box_max = cloud_.origin() + cloud_.points().rowwise().maxCoeff();
    report_.seconds.prepare = watch_.Lap();
  }

  // As many spans as were asked for, or as the data carry; with a loss, the weights it gives too.
  // Where a tolerance refines from one span, only the weights are of interest.
  void ChooseBasis() {
    const bool robust = options_.loss && *options_.loss != Loss::kNone;
    const FittingProblem start = *problem_;
    const int passes = robust && !options_.control_points ? kBasisPasses : 1;
    for (int pass = 0; pass < passes; ++pass) {
      if (options_.control_points) {
        const SplineBasis& basis = problem_->basis_u();
        problem_ = problem_->WithBasis(SplineBasis::Uniform(
            options_.degree, *options_.control_points, basis.lower(), basis.upper()));
      } else if (robust || !options_.tolerance) {
        SpanChoice choice =
            ChooseSpans(*problem_, options_.max_control_points, pool_, options_.progress);
        problem_ = std::move(choice.problem);
        Record(choice.rounds);
      }
      if (!robust) continue;
      problem_ = Reweighted(
          start.WithBasis(problem_->basis_u()),
          {*options_.loss, options_.loss_scale, options_.progress},
          [&](const FittingProblem& problem, const LinearSolution& solution) {
            return CurveDistances(problem, solution.coefficients, distance_, pool_);
          },
          pool_,
          report_.iterations);
    }
    report_.seconds.solve = watch_.Lap();
  }

  void Refine() {
    if (!options_.control_points) {
      const SplineBasis& basis = problem_->basis_u();
      problem_ = problem_->WithBasis(
          SplineBasis::Uniform(options_.degree, options_.degree + 1, basis.lower(), basis.upper()));
    }
    SpanRefineOptions refine;
    refine.tolerance = *options_.tolerance;
    refine.distance = distance_;
    refine.noise = ordered_.noise;
    refine.max_control_points = options_.control_points.value_or(options_.max_control_points);
    SpanRefinement refined = RefineSpans(*problem_, refine, pool_, options_.progress);
    Record(refined.rounds);
    report_.termination = refined.termination;
    problem_ = std::move(refined.problem);
    Take(refined.solution);
    report_.seconds.refine = watch_.Lap();
  }

  void Solve() {
    report_.termination = Termination::kNoiseReached;
    Take(SolveLinear(*problem_, pool_));
    report_.seconds.solve += watch_.Lap();
  }

  void Take(const LinearSolution& solution) {
    curve_ = CurveOf<Dim>(problem_->basis_u(), solution.coefficients);
    if (!solution.regularised) return;
    report_.warnings.push_back(
        "the points do not determine every control point: fairness was raised");
  }

  // What is free by the options or, where they leave it open, where it pays: parameters, or knots
  // where the parameters stay as they are given.
  void OptimiseWhereItPays() {
    OptimizeSummary& summary = report_.optimize;
    const Eigen::VectorXd distances =
        CurveDistances(*problem_, curve_->control_points(), distance_, pool_);
    const double rms = std::sqrt(distances.squaredNorm() / static_cast<double>(distances.size()));
    summary.rms_before = summary.rms_after = rms;
    report_.seconds.project = watch_.Lap();
    if (report_.termination == Termination::kCancelled) return;
    OptimizeOptions optimize;
    if (options_.optimize) {
      optimize.free = *options_.optimize;
      summary.why = optimize.free.any() ? "asked for" : "not asked for";
      if (!optimize.free.any()) return;
    } else {
      const bool held = distance_ == CurveDistance::kParameter;
      optimize.free = {.parameters = !held, .knots = held};
      if (rms <= std::max(kExcessToOptimise * ordered_.noise, Rounding())) {
        summary.why = "residuals are at the noise";
        return;
      }
      if (problem_->size() < kPointsPerFreedomToOptimise * problem_->unknowns()) {
        summary.why = "residuals exceed the noise, but the points are too few for more freedom";
        return;
      }
      summary.why = "residuals exceed the noise";
    }
    if (optimize.free.parameters) distance_ = CurveDistance::kPoint;
    optimize.loss = options_.loss.value_or(Loss::kNone);
    optimize.loss_scale = options_.loss_scale.value_or(std::max(RobustScale(distances), kTiny));
    optimize.fairness = std::min(optimize.fairness, problem_->smoothing());
    optimize.seed = options_.seed;
    optimize.progress = options_.progress;
    OptimizeResult result =
        Optimize(*problem_, curve_->control_points(), curve_->weights(), optimize, pool_);
    summary.ran = result.ran;
    summary.iterations = result.iterations;
    summary.rms_before = result.rms_before;
    summary.rms_after = result.rms_after;
    if (!result.note.empty()) {
      summary.why = result.ran ? summary.why + "; " + result.note : result.note;
    }
    Record(result.rounds);
    if (result.cancelled) report_.termination = Termination::kCancelled;
    problem_ = std::move(result.problem);
    curve_ = NurbsCurve<Dim>(
        problem_->basis_u(), std::move(result.control_points), std::move(result.weights));
    report_.seconds.optimize = watch_.Lap();
  }

  // What is reported is measured on the curve as it is handed out, rounding of far coordinates
  // included.
  CurveFit<Dim> Measure() {
    const Eigen::Matrix<double, Dim, 1> move = (cloud_.origin() - options_.shift).head<Dim>();
    NurbsCurve<Dim> written = Moved(*curve_, middle_ + move);
    const NurbsCurve<Dim> measured = Moved(written, -move);
    const PointDistances found = DistancesTo<Dim>(measured, ordered_.cloud.points(), pool_);
    CurveFit<Dim> fit{std::move(written),
                      found.parameters.row(0)(ordered_.place).transpose(),
                      found.distances(ordered_.place),
                      Forgotten(),
                      {}};
    report_.error = Summarise(fit.residuals, options_.tolerance, !fit.outliers);
    report_.error_all = Summarise(fit.residuals, options_.tolerance);
    if (distance_ == CurveDistance::kParameter) {
      Eigen::VectorXd offsets(cloud_.size());
      for (Eigen::Index k = 0; k < cloud_.size(); ++k) {
        const Eigen::Index place = ordered_.place[static_cast<size_t>(k)];
        offsets[k] =
            (measured.At(ordered_.parameters[place]) - cloud_.points().col(k).template head<Dim>())
                .norm();
      }
      report_.parameter_error = Summarise(offsets, options_.tolerance, !fit.outliers);
      report_.judged_at_parameters = true;
    }
    report_.input.used = report_.error.points;
    report_.input.outliers = fit.outliers.count();
    report_.geometry.kind = "curve";
    report_.geometry.base = Name(options_.parameterization);
    report_.geometry.degree = {options_.degree};
    report_.geometry.control_points = {fit.curve.basis().size()};
    report_.geometry.rational = fit.curve.rational();
    report_.geometry.closed = {false};
    if (fit.curve.basis().size() > ordered_.cloud.size()) {
      report_.warnings.push_back(
          "there are more control points than points: fairness decides the rest");
    }
    JudgeTermination();
    report_.seconds.project += watch_.Lap();
    report_.seconds.total = total_.Lap();
    fit.report = std::move(report_);
    return fit;
  }

  // The points that a loss gives no weight.
  PointMask Forgotten() const {
    PointMask forgotten = PointMask::Constant(cloud_.size(), false);
    const Eigen::VectorXd& weights = problem_->data().weights;
    for (Eigen::Index k = 0; k < cloud_.size() && weights.size() > 0; ++k) {
      forgotten[k] = weights[ordered_.place[static_cast<size_t>(k)]] == 0;
    }
    return forgotten;
  }

  static NurbsCurve<Dim> Moved(const NurbsCurve<Dim>& curve,
                               const Eigen::Matrix<double, Dim, 1>& move) {
    if (move.isZero(0)) return curve;
    return NurbsCurve<Dim>(curve.basis(), curve.control_points().colwise() + move, curve.weights());
  }

  double Rounding() const {
    return kExact * (report_.input.box_max - report_.input.box_min).norm();
  }

  // The word for how it ended, held against what was measured.
  void JudgeTermination() {
    Termination& termination = report_.termination;
    if (termination == Termination::kCancelled) return;
    const ErrorSummary& error = report_.judged_error();
    if (options_.tolerance) {
      if (error.out_of_tolerance == 0) {
        termination = Termination::kToleranceReached;
      } else if (termination == Termination::kToleranceReached) {
        termination = Termination::kStalled;
      }
      return;
    }
    if (error.rms <= std::max(kExcessToSayNoise * ordered_.noise, Rounding())) return;
    termination = options_.control_points ? Termination::kMaxControlPoints : Termination::kStalled;
    if (options_.control_points || !(ordered_.noise > 0)) return;
    report_.warnings.push_back(
        "residuals are well above the noise of neighbouring points, but more equal spans would not "
        "predict left-out points better: the curve has corners or detail that differs much from "
        "place to place");
  }

  void Record(const std::vector<RoundSummary>& rounds) {
    report_.iterations.insert(report_.iterations.end(), rounds.begin(), rounds.end());
  }

  const PointCloud& cloud_;
  const CurveFitOptions& options_;
  ThreadPool pool_;
  Stopwatch watch_, total_;
  FitReport report_;
  CurveDistance distance_;  // kParameter or kPoint
  OrderedPoints ordered_;
  std::optional<FittingProblem> problem_;
  Eigen::Matrix<double, Dim, 1> middle_;  // of the points, in the cloud's local coordinates
  std::optional<NurbsCurve<Dim>> curve_;  // relative to the middle, as the problem's values are
};

[[noreturn]] void Reject(const std::string& rule) {
  throw std::invalid_argument("CurveFitOptions: " + rule);
}

}  // namespace

void Check(const CurveFitOptions& options) {
  if (options.degree < 1 || options.degree > kMaxDegree) {
    Reject("degree is " + std::to_string(options.degree) + ", not in [1, " +
           std::to_string(kMaxDegree) + "]");
  }
  if (options.tolerance && !(*options.tolerance > 0 && std::isfinite(*options.tolerance))) {
    Reject("tolerance must be positive");
  }
  if (options.control_points && *options.control_points <= options.degree) {
    Reject("control_points must exceed the degree");
  }
  constexpr int kMostControlPoints = 1000000;
  if (options.control_points && *options.control_points > kMostControlPoints) {
    Reject("control_points must not exceed a million");
  }
  if (options.max_control_points <= options.degree) {
    Reject("max_control_points must exceed the degree");
  }
  if (options.smoothing && !(*options.smoothing >= 0 && std::isfinite(*options.smoothing))) {
    Reject("smoothing must not be negative");
  }
  if (options.loss_scale && !(*options.loss_scale > 0 && std::isfinite(*options.loss_scale))) {
    Reject("loss_scale must be positive");
  }
  if (options.distance == CurveDistance::kParameter && options.optimize &&
      options.optimize->parameters) {
    Reject("optimize frees the parameters that distance holds every point to");
  }
  if (!options.shift.allFinite()) Reject("shift must be finite");
}

template <int Dim>
CurveFit<Dim> FitCurve(const PointCloud& cloud, const CurveFitOptions& options) {
  Check(options);
  if (cloud.dimension() > Dim) {
    throw std::invalid_argument("the points are in space: a plane curve can't follow them");
  }
  return CurveFitter<Dim>(cloud, options).Run();
}

template CurveFit<2> FitCurve<2>(const PointCloud& cloud, const CurveFitOptions& options);
template CurveFit<3> FitCurve<3>(const PointCloud& cloud, const CurveFitOptions& options);

}  // namespace batten
