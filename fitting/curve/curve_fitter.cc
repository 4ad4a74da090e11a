// SPDX-License-Identifier: MIT
#include "fitting/curve/curve_fitter.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "batten/fitting/curve_spans.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/optimize.h"
#include "batten/fitting/solve_linear.h"
#include "fitting/core/point_rank.h"
#include "fitting/core/rules.h"
#include "fitting/core/stage_clock.h"
#include "fitting/curve/curve_cut.h"
#include "fitting/curve/curve_ends.h"
#include "fitting/curve/curve_outcome.h"
#include "fitting/curve/curve_robustness.h"
#include "fitting/curve/distance_minimisation.h"
#include "fitting/curve/fit_corners.h"
#include "fitting/curve/knot_relocation.h"
#include "fitting/curve/overshoot.h"
#include "fitting/curve/parameter_correction.h"
#include "fitting/curve/rational_spans.h"
#include "fitting/curve/span_adaptation.h"
#include "fitting/least_squares/choose_smoothing.h"
#include "fitting/least_squares/reweighting.h"
#include "fitting/ordering/row_means.h"

namespace batten::internal {
namespace {

constexpr double kSmoothing = 1e-10;  // relative fairness: bridges data gaps, negligible elsewhere
constexpr int kBasisPasses = 2;       // weights choose spans, spans choose weights
constexpr int kRobustPasses = 3;
constexpr double kExactAgainstNoise = 0.2;
constexpr double kLargest = 1.3;  // largest size of a joint result over the points'
constexpr double kFirstRegularization = 1e-8, kLastRegularization = 1e-3, kRegularizationStep = 10;
constexpr double kManyOutliers = 0.003;  // share of the points: above it some were missed
constexpr double kExcessToOptimise =
    1.1;  // rms residual over noise: below, no joint optimization without a tolerance
constexpr double kPointsPerFreedomToOptimise = 3, kPointsPerFreedomForTolerance = 2;
constexpr double kTiny = 1e-300;  // a scale must be positive, even of residuals that vanish
constexpr double kExact = 1e-9;   // share of the cloud's size: below it rounding
constexpr double kAlike = 1e-8;   // share of the size: curves that differ less are equal
constexpr int kPointsOfSmoothSpan = 3, kMostSmoothSpans = 200;
constexpr int kStartSpans = 15, kStartForTolerance = 5;
constexpr Eigen::Index kPointsOfStartSpan = 8;
constexpr Eigen::Index kManyPoints = 20000, kMeans = 4000, kManyUnderLoss = 10000;
constexpr int kFootPointSteps = 2;
constexpr double kFewForControlPoint = 4;  // data
constexpr int kRoundsOfDistance = 20;
constexpr double kVariancesPerControlPoint = 3;
constexpr int kMostToRelocate = 80;  // spans; the time grows with their square

EndCode SearchEnd(Termination termination) {
  return termination == Termination::kToleranceReached   ? EndCode::kToleranceReached
         : termination == Termination::kMaxControlPoints ? EndCode::kMaxControlPoints
         : termination == Termination::kCancelled        ? EndCode::kCancelled
                                                         : EndCode::kCrossValidated;
}

// One fit, stage by stage; members are what the stages hand on.
template <int Dim>
class CurveFitter {
 public:
  CurveFitter(const PointCloud& cloud,
              const OrderedPoints& ordered,
              const PointMask& sequence_outliers,
              const CurveFitOptions& options,
              ThreadPool& pool,
              StageClock& clock)
      : cloud_(cloud),
        ordered_(ordered),
        sequence_outliers_(sequence_outliers),
        options_(options),
        pool_(pool),
        clock_(clock) {
    report_.threads = pool_.threads();
    distance_ = options.distance;
    if (distance_ == CurveDistance::kAuto) {
      distance_ = options.parameterization == CurveParameterization::kGiven
                      ? CurveDistance::kParameter
                      : CurveDistance::kPoint;
    }
    if (distance_ == CurveDistance::kTangent) model_ = DistanceModel::kTangent;
    if (distance_ == CurveDistance::kSquared) model_ = DistanceModel::kSquared;
    if (model_) distance_ = CurveDistance::kPoint;
  }

  CurveFit<Dim> Run() {
    RequireEnough();
    MakeProblem();
    clock_.Enter(&StageSeconds::parameterize);
    FindCorners();
    clock_.Enter(&StageSeconds::solve);
    if (distance_ == CurveDistance::kParameter && !ordered_.closed) {
      FitAtParameters();
    } else if (options_.smooth_by != SmoothBy::kWeight) {
      FitSmoothly();
    } else if (options_.control_points) {
      FitWithControlPoints();
    } else {
      FitAdaptively();
    }
    if (!FitRationally()) OptimiseWhereItPays();
    return Measure();
  }

 private:
  void RequireEnough() const {
    const Eigen::Index points = ordered_.cloud.size();
    if (points <= options_.degree) {
      throw std::invalid_argument(std::to_string(points) +
                                  " different points are too few for a curve of degree " +
                                  std::to_string(options_.degree) + ": lower the degree to " +
                                  std::to_string(std::max<Eigen::Index>(1, points - 1)));
    }
    if (ordered_.closed && points < 3) {
      throw std::invalid_argument("a closed curve needs at least 3 different points");
    }
    if (ordered_.closed && options_.optimize && options_.optimize->knots) {
      throw std::invalid_argument(
          "the knots of a closed curve can't be free; without closing it (closed no) they can");
    }
  }

  void MakeProblem() {
    Report(options_.progress, "prepare", 0);
    auto data = std::make_shared<FittingData>();
    const Eigen::VectorXd& u = ordered_.parameters;
    data->parameters = Eigen::Matrix2Xd::Zero(2, u.size());
    data->parameters.row(0) = u;
    data->values = ordered_.cloud.points().template topRows<Dim>();
    middle_ = data->values.rowwise().mean();
    data->values.colwise() -= middle_;
    size_ = (data->values.rowwise().maxCoeff() - data->values.rowwise().minCoeff()).norm();
    const Eigen::VectorXd& weights = ordered_.cloud.weights();
    if (weights.size() > 0) data->weights = weights / weights.mean();
    problem_ = FittingProblem(
        SplineBasis::Uniform(options_.degree, options_.degree + 1, ordered_.lower, ordered_.upper),
        std::move(data),
        options_.smoothing.value_or(kSmoothing));
    InputSummary& input = report_.input;
    input.points = cloud_.size();
    input.duplicates = ordered_.repeats;
    input.spacing = ordered_.spacing;
    input.noise = noise_ = ordered_.noise;
    input.origin = cloud_.origin();
    input.box_min = cloud_.origin() + cloud_.points().rowwise().minCoeff();
    input.box_max = cloud_.origin() + cloud_.points().rowwise().maxCoeff();
  }

  // Corners, and the parameters with the seam at one of them.
  void FindCorners() {
    given_ = problem_->data().parameters.row(0).transpose();
    near_exact_ = FollowsClosely(ordered_);
    if (!Acts(Rule::kCorners) || !options_.corners || options_.degree < 2 || distance_ == CurveDistance::kParameter) return;
    FitCorners found = CornersForFit(
        ordered_, options_.degree, options_.control_points.value_or(options_.max_control_points));
    corners_ = std::move(found.parameters);
    anchored_ = std::move(found.anchored);
    sought_as_exact_ = found.sought_as_exact;
    given_ = found.data;
    Eigen::Matrix2Xd parameters = problem_->data().parameters;
    parameters.row(0) = given_;
    problem_ = problem_->WithParameters(std::move(parameters));
  }

  SpanLayout EqualSpans(int spans, std::vector<double> corners) const {
    std::sort(corners.begin(), corners.end());
    return SpanLayout::Equal(
        options_.degree, spans, ordered_.lower, ordered_.upper, corners, ordered_.closed);
  }

  // Fits at the given parameters, with the number of spans asked for or chosen by the data; with a
  // loss, also with its weights.
  void FitAtParameters() {
    const bool robust = options_.loss && *options_.loss != Loss::kNone;
    const FittingProblem start = *problem_;
    const int passes = robust && !options_.control_points ? kBasisPasses : 1;
    for (int pass = 0; pass < passes; ++pass) {
      if (options_.control_points) {
        problem_ = problem_->WithBasis(Uniform(*options_.control_points));
      } else if (robust || !options_.tolerance) {
        SpanChoice choice =
            ChooseSpans(*problem_, options_.max_control_points, pool_, options_.progress);
        problem_ = std::move(choice.problem);
        Record(choice.rounds);
      }
      if (robust) Reweight(start.WithBasis(problem_->basis_u()));
    }
    if (options_.tolerance) {
      RefineAtParameters();
    } else {
      report_.end.code = EndCode::kCrossValidated;
      Take(SolveLinear(*problem_, pool_));
    }
  }

  SplineBasis Uniform(int control_points) const {
    return SplineBasis::Uniform(options_.degree, control_points, ordered_.lower, ordered_.upper);
  }

  void Reweight(const FittingProblem& problem) {
    problem_ = Reweighted(
        problem,
        {*options_.loss, options_.loss_scale, options_.progress},
        [&](const FittingProblem& current, const LinearSolution& solution) {
          return CurveDistances(current, solution.coefficients, distance_, pool_);
        },
        pool_,
        report_.iterations);
  }

  void RefineAtParameters() {
    clock_.Enter(&StageSeconds::refine);
    if (!options_.control_points) problem_ = problem_->WithBasis(Uniform(options_.degree + 1));
    SpanRefineOptions refine;
    refine.tolerance = *options_.tolerance;
    refine.distance = distance_;
    refine.noise = ordered_.noise;
    refine.max_control_points = options_.control_points.value_or(options_.max_control_points);
    SpanRefinement refined = RefineSpans(*problem_, refine, pool_, options_.progress);
    Record(refined.rounds);
    report_.end.code = SearchEnd(refined.termination);
    problem_ = std::move(refined.problem);
    Take(refined.solution);
  }

  SpanAdaptOptions AdaptOptions() const {
    SpanAdaptOptions adapt;
    adapt.tolerance = options_.tolerance;
    adapt.feet = distance_ == CurveDistance::kPoint;
    adapt.exact = kAlike * size_;
    adapt.noise = noise_;
    if (problem_->size() <= kManyPoints) adapt.anchored = anchored_;
    adapt.max_control_points = options_.max_control_points;
    adapt.progress = options_.progress;
    return adapt;
  }

  // Adapts from a few equal spans to as many as the data distinguish or the tolerance needs.
  SpanAdaptation Adapted(const FittingProblem& problem, const std::vector<double>& corners) const {
    const Eigen::Index few = std::max<Eigen::Index>(1, problem.size() / kPointsOfStartSpan);
    const int start = options_.tolerance ? kStartForTolerance : kStartSpans;
    const auto sharp = static_cast<int>(corners.size());
    const int room = options_.max_control_points - (ordered_.closed ? 0 : options_.degree) -
                     sharp * (options_.degree - 1);
    const int spans = std::min(static_cast<int>(std::min<Eigen::Index>(start, few)), room);
    // Around a closed curve more control points than the degree.
    const int least = options_.degree + 1 - (options_.degree - 1) * sharp;
    const int fewest = std::max({1, sharp, ordered_.closed ? least : 1});
    SpanAdaptation adapted =
        AdaptSpans(problem, EqualSpans(std::max(fewest, spans), corners), AdaptOptions(), pool_);
    if (adapted.layout.spans() > kMostToRelocate || !Acts(Rule::kRelocatedKnots)) return adapted;
    if (options_.tolerance)
      return RelocatedWithinTolerance(std::move(adapted), AdaptOptions(), pool_);
    return RelocatedSpans(std::move(adapted), AdaptOptions(), pool_);
  }

  // Adapts with the corners that were found, unless with noise a smooth curve explains the data as
  // well with fewer control points: an apparent corner may be a bend of the whole curve.
  SpanAdaptation Adapted(const FittingProblem& problem) {
    SpanAdaptation sharp = Adapted(problem, corners_);
    if (corners_.empty() || near_exact_ || !Acts(Rule::kSmoothForCorners)) return sharp;
    const Eigen::VectorXd off = AtTheirPlaces(sharp.problem, sharp.solution.coefficients);
    const double left = std::sqrt(off.squaredNorm() / static_cast<double>(problem.size()));
    if (sought_as_exact_ && left < kExactAgainstNoise * ordered_.noise) return sharp;
    std::vector<Eigen::Index> anchored;
    std::swap(anchored, anchored_);
    SpanAdaptation smooth = Adapted(problem, {});
    const double variance = std::max(
        {std::pow(std::min(sharp.noise, smooth.noise), 2), std::pow(kAlike * size_, 2), kTiny});
    const auto score = [&](const SpanAdaptation& adapted) {
      const Eigen::VectorXd distances =
          AtTheirPlaces(adapted.problem, adapted.solution.coefficients);
      const double missed = options_.tolerance
                                ? std::max(0.0, distances.maxCoeff() - *options_.tolerance)
                                : distances.squaredNorm() / variance;
      return std::pair(options_.tolerance ? missed : 0.0,
                       (options_.tolerance ? 0 : missed) +
                           kVariancesPerControlPoint * adapted.layout.control_points());
    };
    if (sought_as_exact_ || score(smooth) < score(sharp)) {
      corners_.clear();
      return smooth;
    }
    std::swap(anchored, anchored_);
    return sharp;
  }

  void FitAdaptively() {
    std::optional<Loss> loss = options_.loss;
    const auto sequence_outliers = static_cast<double>(sequence_outliers_.count());
    const bool noisy = ordered_.noise > 0;  // else what is off is the curve
    if (!loss && noisy &&
        sequence_outliers > kManyOutliers * static_cast<double>(sequence_outliers_.size()))
      loss = Loss::kTukey;
    const bool robust = loss && *loss != Loss::kNone;
    const bool many = problem_->size() > kManyPoints && !options_.tolerance;
    SpanAdaptation adapted =
        robust ? AdaptedUnderLoss(many ? EveryFewData(*problem_, kManyUnderLoss) : *problem_, *loss)
               : Adapted(many ? MeansOfRows(*problem_, kMeans) : *problem_);
    if (!robust) Record(adapted.rounds);
    if (many && robust) adapted = AdaptedToAll(adapted, *loss);
    const double means = many ? static_cast<double>(problem_->size()) / kMeans : 1;
    if (noise_ == 0) noise_ = adapted.noise * std::sqrt(means);
    report_.end.code = adapted.full ? EndCode::kMaxControlPoints : EndCode::kCrossValidated;
    FittingProblem whole = !many    ? std::move(adapted.problem)
                           : robust ? WeightedWhole(adapted, *loss)
                                    : problem_->WithBasis(adapted.layout.Basis());
    Settle(std::move(whole), adapted.layout);
  }

  RobustCurve Losses(Loss loss, bool all) const {
    return {loss,
            options_.loss_scale,
            !options_.loss,
            distance_ == CurveDistance::kPoint,
            std::max(kAlike * size_, kTiny),
            all ? anchored_ : std::vector<Eigen::Index>{}};
  }

  // Adaptation and weights in turn; the problem that comes back has the weights of the loss.
  SpanAdaptation AdaptedUnderLoss(const FittingProblem& problem, Loss loss) {
    const RobustCurve losses = Losses(loss, problem.size() == problem_->size());
    SpanAdaptation adapted = Adapted(problem);
    Record(adapted.rounds);
    if (noise_ == 0) noise_ = adapted.noise;
    const Eigen::VectorXd own = problem.data().weights;
    if (Acts(Rule::kLeastAbsolute)) adapted = NearLeastAbsolute(std::move(adapted), losses, pool_);
    for (int pass = 0; pass < kRobustPasses; ++pass) {
      const FittingProblem weighted = WeightedByLoss(adapted, losses, own, pool_);
      adapted = Adapted(weighted);
      Record(adapted.rounds);
    }
    adapted.problem = WeightedByLoss(adapted, losses, own, pool_);
    return adapted;
  }

  // Returns all data at their foot points on a curve fitted to some of them or to means, weighted
  // by the loss.
  FittingProblem WeightedWhole(const SpanAdaptation& part, Loss loss) const {
    const FittingProblem whole = problem_->WithBasis(part.layout.Basis());
    const SpanAdaptation all{
        part.layout,
        distance_ == CurveDistance::kPoint
            ? CorrectedParameters(whole, part.solution.coefficients, pool_, anchored_)
            : whole,
        part.solution,
        part.noise,
        part.full,
        {}};
    return WeightedByLoss(all, Losses(loss, true), whole.data().weights, pool_);
  }

  // Adapts to all data, with the outliers taken from a fit to some of them.
  SpanAdaptation AdaptedToAll(const SpanAdaptation& some, Loss loss) {
    SpanAdaptation adapted = Adapted(MeansOfRows(WeightedWhole(some, loss), kMeans));
    Record(adapted.rounds);
    return adapted;
  }

  // Makes the last fits on all data; noisy open ends are extended to their points first.
  void Settle(FittingProblem problem, SpanLayout layout) {
    // Of many points one step says as much.
    const int steps = distance_ != CurveDistance::kPoint ? 0
                      : problem.size() > kManyPoints     ? 1
                                                         : kFootPointSteps;
    CorrectedFit fit = FitWithCorrection(problem, steps, pool_, anchored_);
    if (steps > 0 && !layout.closed() && noise_ > ordered_.spacing && Acts(Rule::kLooseEnds)) {
      layout = WithLooseEnds(layout, fit, noise_, ordered_.spacing);
      fit = FitWithCorrection(fit.problem.WithBasis(layout.Basis()), steps, pool_, anchored_);
    }
    // Of few points the parameters are the larger part of the error.
    const bool few =
        static_cast<double>(problem.size()) < kFewForControlPoint * layout.control_points();
    if (steps > 0 && (model_ || (anchored_.empty() && (few || options_.tolerance)))) {
      fit = AtMinimumDistance(fit, Minimisation(), pool_);
      RoundSummary round;
      round.stage = model_ == DistanceModel::kSquared ? "squared distance" : "tangent distance";
      round.control_points_u = problem.unknowns();
      round.control_points_v = 1;
      round.rms = std::sqrt(fit.solution.residual_squares / static_cast<double>(problem.size()));
      round.score = fit.steps;
      Record({round});
    }
    problem_ = std::move(fit.problem);
    Take(Regularized(std::move(fit.solution)));
  }

  // Returns the problem's solution, with more fairness where the curve overshoots between its data.
  LinearSolution Regularized(LinearSolution solution) {
    if (!Acts(Rule::kOvershoot)) return solution;
    bool told = false;
    for (double smoothing = kFirstRegularization; smoothing <= kLastRegularization;
         smoothing *= kRegularizationStep) {
      if (!HasOvershoot(*problem_, solution.coefficients, {}, noise_)) break;
      if (smoothing <= problem_->smoothing()) continue;
      problem_ = problem_->WithSmoothing(smoothing);
      solution = SolveLinear(*problem_, pool_);
      if (std::exchange(told, true)) continue;
      report_.warnings.push_back(
          "the points leave parts of the curve open: fairness was raised there and everywhere");
    }
    return solution;
  }

  DistanceMinimisationOptions Minimisation() const {
    DistanceMinimisationOptions minimise;
    minimise.model = model_.value_or(DistanceModel::kTangent);
    if (!model_) minimise.max_rounds = kRoundsOfDistance;
    minimise.progress = options_.progress;
    return minimise;
  }

  // Fits more spans than the data need, with a fairness weight that suppresses the noise: chosen on
  // means where there are many points, which keeps its meaning, and once more at the foot points.
  void FitSmoothly() {
    const auto most = static_cast<int>(problem_->size() / kPointsOfSmoothSpan);
    const int beside = (ordered_.closed ? 0 : options_.degree) +
                       (options_.degree - 1) * static_cast<int>(corners_.size());
    const int spans =
        options_.control_points
            ? *options_.control_points - beside
            : std::min({most, kMostSmoothSpans, options_.max_control_points - beside});
    const SpanLayout layout = EqualSpans(
        std::max(ordered_.closed && corners_.empty() ? options_.degree + 1 : 1, spans), corners_);
    FittingProblem problem = problem_->WithBasis(layout.Basis());
    for (int pass = 0; pass < 2; ++pass) {
      problem = problem.WithSmoothing(
          options_.smooth_by == SmoothBy::kNoise
              ? SmoothingFromNoise(problem,
                                   std::max({ordered_.noise, kAlike * size_, kTiny}),
                                   pool_,
                                   options_.progress)
              : SmoothingByCrossValidation(problem, pool_, options_.progress));
      const int steps = distance_ == CurveDistance::kPoint ? 1 : 0;
      problem = FitWithCorrection(problem, steps, pool_, anchored_).problem;
    }
    report_.end.code = EndCode::kCrossValidated;
    problem_ = std::move(problem);
    Take(SolveLinear(*problem_, pool_));
  }

  // Fits the number of control points asked for, with equal spans or spans adapted to the data.
  void FitWithControlPoints() {
    const int asked = *options_.control_points;
    const int ends = ordered_.closed ? 0 : options_.degree;
    const int spans = asked - ends - (options_.degree - 1) * static_cast<int>(corners_.size());
    if (spans < 1 || (ordered_.closed && asked <= options_.degree)) {
      throw std::invalid_argument("a closed curve of degree " + std::to_string(options_.degree) +
                                  " needs more than " + std::to_string(options_.degree) +
                                  " control points");
    }
    const int steps = distance_ == CurveDistance::kPoint ? kFootPointSteps : 0;
    SpanLayout layout = EqualSpans(spans, corners_);
    CorrectedFit fit =
        FitWithCorrection(problem_->WithBasis(layout.Basis()), steps, pool_, anchored_);
    for (const SpanLayout& other : SpreadLayouts(layout)) {
      CorrectedFit trial =
          FitWithCorrection(problem_->WithBasis(other.Basis()), steps, pool_, anchored_);
      if (!(trial.solution.residual_squares < fit.solution.residual_squares)) continue;
      fit = std::move(trial);
      layout = other;
    }
    report_.end.code = EndCode::kMaxControlPoints;
    if (options_.loss && *options_.loss != Loss::kNone) {
      Reweight(fit.problem);
      fit.problem = *problem_;
    }
    Settle(std::move(fit.problem), layout);
  }

  // Layouts with as many spans as `even`, adapted to the data: with the density that adaptation
  // finds, and both with relocated knots.
  std::vector<SpanLayout> SpreadLayouts(const SpanLayout& even) const {
    const int spans = even.spans();
    if (spans <= 1 + static_cast<int>(corners_.size())) return {};
    SpanAdaptOptions adapt = AdaptOptions();
    adapt.tolerance.reset();
    const bool many = problem_->size() > kManyPoints;
    const FittingProblem problem = many ? MeansOfRows(*problem_, kMeans) : *problem_;
    const int start = std::min(kStartSpans, spans);
    const SpanAdaptation free = AdaptSpans(problem, EqualSpans(start, corners_), adapt, pool_);
    std::vector<SpanLayout> layouts{free.layout.Resampled(spans)};
    if (spans > kMostToRelocate) return layouts;
    const LayoutTrials trials(free.problem, spans);
    layouts.push_back(RelocateKnots(trials, layouts.front()));
    layouts.push_back(RelocateKnots(trials, even));
    return layouts;
  }

  void Take(const LinearSolution& solution) {
    squares_ = solution.residual_squares;
    curve_ = CurveOf<Dim>(problem_->basis_u(), solution.coefficients);
    if (!solution.regularised) return;
    report_.warnings.push_back(
        "the points do not determine every control point: fairness was raised");
  }

  // Runs the joint optimisation over what the options free or, where they leave it open, where it
  // pays: over parameters, or over knots where the parameters are given.
  void OptimiseWhereItPays() {
    OptimizeSummary& summary = report_.optimize;
    // Of many points the squares of the solution say as much, at once.
    const bool many = problem_->size() > kManyPoints && !options_.optimize && !options_.tolerance;
    const double before = std::sqrt(squares_ / static_cast<double>(problem_->size()));
    if (many && before <= kExcessToOptimise * std::sqrt(Directions()) * noise_) {
      summary.rms_before = summary.rms_after = before;
      summary.why = "residuals are at the noise";
      return;
    }
    clock_.Enter(&StageSeconds::project);
    const Eigen::VectorXd distances = AtTheirPlaces(*problem_, curve_->control_points());
    const double rms = std::sqrt(distances.squaredNorm() / static_cast<double>(distances.size()));
    summary.rms_before = summary.rms_after = rms;
    clock_.Enter(&StageSeconds::optimize);
    if (report_.end.code == EndCode::kCancelled) return;
    OptimizeOptions optimize;
    if (options_.optimize) {
      optimize.free = *options_.optimize;
      summary.why = optimize.free.any() ? "asked for" : "not asked for";
      if (!optimize.free.any()) return;
    } else {
      const bool held = distance_ == CurveDistance::kParameter;
      optimize.free = {.parameters = !held, .knots = held};
      if (held && problem_->basis_u().periodic()) {
        summary.why = "the knots of a closed curve are not free";
        return;
      }
      if (options_.tolerance && distances.maxCoeff() <= *options_.tolerance) {
        summary.why = "the tolerance is kept";
        return;
      }
      if (!options_.tolerance &&
          rms <= std::max(kExcessToOptimise * std::sqrt(Directions()) * noise_, Rounding())) {
        summary.why = "residuals are at the noise";
        return;
      }
      const double enough =
          options_.tolerance ? kPointsPerFreedomForTolerance : kPointsPerFreedomToOptimise;
      if (static_cast<double>(problem_->size()) < enough * problem_->unknowns()) {
        summary.why = "residuals exceed the noise, but the points are too few for more freedom";
        return;
      }
      summary.why = "residuals exceed the noise";
    }
    if (problem_->size() < problem_->unknowns()) {
      summary.why = "there are fewer points than control points";
      return;
    }
    if (optimize.free.parameters) distance_ = CurveDistance::kPoint;
    SetUp(optimize, distances);
    Adopt(Optimize(*problem_, curve_->control_points(), curve_->weights(), optimize, pool_));
  }

  void SetUp(OptimizeOptions& optimize, const Eigen::VectorXd& distances) const {
    optimize.loss = options_.loss.value_or(Loss::kNone);
    optimize.loss_scale = options_.loss_scale.value_or(std::max(RobustScale(distances), kTiny));
    optimize.fairness = std::min(optimize.fairness, problem_->smoothing());
    optimize.seed = options_.seed;
    optimize.progress = options_.progress;
  }

  // Tries few rational spans where weights are free.
  bool FitRationally() {
    if (!options_.optimize || !options_.optimize->weights || options_.control_points) return false;
    clock_.Enter(&StageSeconds::optimize);
    OptimizeSummary& summary = report_.optimize;
    const Eigen::VectorXd distances = AtTheirPlaces(*problem_, curve_->control_points());
    RationalSpansOptions rational;
    rational.optimize.free = *options_.optimize;
    SetUp(rational.optimize, distances);
    rational.goal = std::max(near_exact_ ? 0 : noise_, Rounding());
    rational.tolerance = options_.tolerance;
    rational.most_control_points = problem_->unknowns();
    const SplineBasis& basis = problem_->basis_u();
    const SpanLayout start = SpanLayout::Equal(options_.degree,
                                               1 + static_cast<int>(corners_.size()),
                                               basis.lower(),
                                               basis.upper(),
                                               corners_,
                                               ordered_.closed);
    // Parameters as they came: feet on many spans are not those of few.
    Eigen::Matrix2Xd parameters = problem_->data().parameters;
    parameters.row(0) = given_;
    std::optional<OptimizeResult> found = FewestRationalSpans(
        problem_->WithParameters(std::move(parameters)), start, rational, pool_);
    if (!found) return false;
    summary.why = "asked for; fewer spans do with weights";
    Adopt(std::move(*found));
    return true;
  }

  void Adopt(OptimizeResult&& result) {
    OptimizeSummary& summary = report_.optimize;
    summary.ran = result.ran;
    summary.iterations = result.iterations;
    summary.rms_before = result.rms_before;
    summary.rms_after = result.rms_after;
    if (!result.note.empty()) {
      summary.why = result.ran ? summary.why + "; " + result.note : result.note;
    }
    Record(result.rounds);
    if (result.cancelled) report_.end.code = EndCode::kCancelled;
    NurbsCurve<Dim> curve(
        result.problem.basis_u(), std::move(result.control_points), std::move(result.weights));
    const bool regularized =
        !HasOvershoot(result.problem, curve.control_points(), curve.weights(), noise_) ||
        HasOvershoot(*problem_, curve_->control_points(), curve_->weights(), noise_);
    const auto size = [](const NurbsCurve<Dim>& shape) {
      return SampledSize(shape.basis(), shape.control_points(), shape.weights());
    };
    if (!regularized || size(curve) > kLargest * std::max(size_, size(*curve_))) {
      summary.why += "; not taken, as it left the points between them";
      summary.rms_after = summary.rms_before;
    } else if (distance_ != CurveDistance::kPoint) {
      problem_ = std::move(result.problem);
      curve_ = std::move(curve);
    } else if (auto cut = CutToData(curve, result.problem.data())) {
      problem_ = result.problem.WithBasis(cut->curve.basis()).WithParameters(cut->parameters);
      curve_ = std::move(cut->curve);
    } else {
      summary.why += "; not taken, as it left the ends of the points";
      summary.rms_after = summary.rms_before;
    }
  }

  // Returns the distances at the parameters, orthogonal to the curve where these are foot points.
  Eigen::VectorXd AtTheirPlaces(const FittingProblem& problem, const Eigen::MatrixXd& net) const {
    return DistancesAt(problem, net, distance_ == CurveDistance::kPoint, pool_);
  }

  CurveFit<Dim> Measure() {
    clock_.Enter(&StageSeconds::project);
    return MeasuredCurve<Dim>({cloud_,
                               ordered_,
                               sequence_outliers_,
                               options_,
                               problem_->data().weights,
                               problem_->data().parameters.row(0).transpose(),
                               distance_,
                               noise_,
                               problem_->unknowns()},
                              *curve_,
                              middle_,
                              std::move(report_),
                              pool_);
  }

  // The number of directions that the noise has: plane points in space are noisy in the plane only.
  double Directions() const {
    const int along = distance_ == CurveDistance::kPoint ? 1 : 0;
    return std::max(1, PointRank(problem_->data().values) - along);
  }

  double Rounding() const {
    return kExact * (report_.input.box_max - report_.input.box_min).norm();
  }

  void Record(const std::vector<RoundSummary>& rounds) {
    report_.iterations.insert(report_.iterations.end(), rounds.begin(), rounds.end());
  }

  const PointCloud& cloud_;
  const OrderedPoints& ordered_;
  const PointMask& sequence_outliers_;
  const CurveFitOptions& options_;
  ThreadPool& pool_;
  StageClock& clock_;
  FitReport report_;
  CurveDistance distance_;                             // kParameter or kPoint
  std::optional<DistanceModel> model_ = std::nullopt;  // to go on with after points
  double size_ = 0;                                    // of the points' box
  double squares_ = 0;                                 // Σ w d² of the solution
  double noise_ = 0;                                   // standard deviation across the curve
  std::vector<double> corners_;                        // their parameters, sharpest first
  bool near_exact_ = false, sought_as_exact_ = false;  // of the points, and of their corners
  Eigen::VectorXd given_;                              // parameters before any fit
  std::vector<Eigen::Index> anchored_;                 // data at corners
  std::optional<FittingProblem> problem_;
  Eigen::Matrix<double, Dim, 1> middle_;  // of the points, in the cloud's local coordinates
  std::optional<NurbsCurve<Dim>> curve_;  // relative to the middle, as the problem's values are
};

}  // namespace

template <int Dim>
CurveFit<Dim> FitOrdered(const PointCloud& cloud,
                         const OrderedPoints& ordered,
                         const PointMask& sequence_outliers,
                         const CurveFitOptions& options,
                         ThreadPool& pool,
                         StageClock& clock) {
  return CurveFitter<Dim>(cloud, ordered, sequence_outliers, options, pool, clock).Run();
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
