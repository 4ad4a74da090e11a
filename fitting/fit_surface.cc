// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_surface.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>

#include "batten/fitting/distances.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/grid_selection.h"
#include "batten/fitting/height_field.h"
#include "batten/fitting/joint_stage.h"
#include "batten/fitting/neighbours.h"
#include "batten/fitting/plane_base.h"
#include "batten/fitting/refine.h"
#include "batten/fitting/strangers.h"
#include "batten/fitting/surface_preparation.h"
#include "batten/fitting/voids.h"

namespace batten {
namespace {

constexpr double kSmoothing = 1e-4;
constexpr double kOutlierShareForLoss =
    2e-3;  // less is what the test for outliers flags on clean data
constexpr double kOverlapToWarn = 0.02;
constexpr double kOverlapToRefuse = 0.15;
constexpr double kLeastScale = 1e-3;        // of the spacing: what exact points may be off by
constexpr double kOutlierInScales = 4.685;  // where Tukey's loss stops counting a point
constexpr double kVoidShareToWarn = 0.05;
constexpr int kOutlierPasses = 5;
constexpr double kFewChanges = 0.01;
constexpr int kLargeGrid = 1500;              // searching its size anew takes long …
constexpr Eigen::Index kManyPoints = 200000;  // … as it does with many points
constexpr int kHuberRounds = 8, kTukeyRounds = 8;
constexpr double kExcessToOptimise = 1.2;  // residual against noise
constexpr double kExcessToSayNoise = 2;
constexpr double kExact = 1e-9;  // of the cloud's size: rounding
constexpr double kPointsPerFreedomToOptimise = 9;
constexpr int kMostToOptimise = 1500;

class Stopwatch {
 public:
  // Seconds since construction or the last call.
  double Lap() {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double>(now - std::exchange(last_, now)).count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

// Heights over the base at the merged points that are used; parameters a hair inside the domain.
FittingProblem MakeProblem(const PreparedCloud& prepared,
                           const PointCloud& points,
                           const SurfaceFitOptions& options) {
  const Eigen::Matrix3Xd local = prepared.base.ToFrame(points.points());
  auto data = std::make_shared<FittingData>();
  data->parameters.resize(2, local.cols());
  data->parameters.row(0) = local.row(0).cwiseMax(0.0).cwiseMin(prepared.base.length_u);
  data->parameters.row(1) = local.row(1).cwiseMax(0.0).cwiseMin(prepared.base.length_v);
  data->values = local.row(2);
  if (points.weights().size() > 0) data->weights = points.weights() / points.weights().mean();
  return FittingProblem(FittingBasis(options.degree_u, 1, 0, prepared.base.length_u),
                        FittingBasis(options.degree_v, 1, 0, prepared.base.length_v),
                        std::move(data),
                        options.smoothing.value_or(kSmoothing));
}

FittingProblem ChooseBases(const FittingProblem& problem,
                           const SurfaceFitOptions& options,
                           const FittingProblem* similar,
                           ThreadPool& pool,
                           FitReport& report) {
  int cells_u, cells_v;
  if (options.control_points) {
    cells_u = options.control_points->first - options.degree_u;
    cells_v = options.control_points->second - options.degree_v;
  } else {
    GridLimits limits;
    limits.degree_u = options.degree_u;
    limits.degree_v = options.degree_v;
    limits.max_control_points = options.max_control_points;
    if (similar != nullptr) {
      limits.near_cells_u = similar->basis_u().size() - options.degree_u;
      limits.near_cells_v = similar->basis_v().size() - options.degree_v;
    }
    GridChoice choice = ChooseGrid(problem, limits, pool, options.progress);
    report.iterations.insert(report.iterations.end(), choice.rounds.begin(), choice.rounds.end());
    cells_u = choice.cells_u;
    cells_v = choice.cells_v;
  }
  return problem.WithBases(
      FittingBasis(options.degree_u, cells_u, problem.basis_u().lower(), problem.basis_u().upper()),
      FittingBasis(
          options.degree_v, cells_v, problem.basis_v().lower(), problem.basis_v().upper()));
}

// The part of a height's residual along the surface normal.
Eigen::VectorXd NormalResiduals(const FittingProblem& problem,
                                const NurbsSurface& surface,
                                const PlaneBase& base,
                                const Eigen::MatrixXd& heights,
                                ThreadPool& pool) {
  Eigen::VectorXd residuals(problem.size());
  const Eigen::Vector3d up = base.axes.col(2);
  pool.For(problem.size(), 1024, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      const auto normal =
          surface.NormalAt(problem.data().parameters(0, k), problem.data().parameters(1, k));
      residuals[k] =
          (problem.data().values(0, k) - heights(0, k)) * (normal ? normal->dot(up) : 1.0);
    }
  });
  return residuals;
}

// Iterative reweighting at fixed bases: returns the problem with its final weights.
FittingProblem Reweighted(const FittingProblem& problem,
                          const PlaneBase& base,
                          const SurfaceFitOptions& options,
                          ThreadPool& pool,
                          FitReport& report) {
  const bool automatic = !options.loss;
  const Eigen::VectorXd original = problem.data().weights.size() > 0
                                       ? problem.data().weights
                                       : Eigen::VectorXd::Ones(problem.size()).eval();
  FittingProblem current = problem;
  const int rounds = automatic ? kHuberRounds + kTukeyRounds : 2 * kHuberRounds;
  double previous = 0;
  for (int round = 0; round < rounds; ++round) {
    Report(options.progress, "solve", static_cast<double>(round) / rounds);
    Stopwatch watch;
    // Tukey's loss forgets far points, so it starts only where Huber's has found the bulk.
    const bool start = round < kHuberRounds && (automatic || *options.loss == Loss::kTukey);
    const Loss loss = start ? Loss::kHuber : options.loss.value_or(Loss::kTukey);
    const LinearSolution solution = SolveLinear(current, pool);
    const NurbsSurface surface =
        HeightSurface(base, current.basis_u(), current.basis_v(), solution.coefficients);
    const Eigen::MatrixXd heights = EvaluateAt(current, solution.coefficients, pool);
    const Eigen::VectorXd residuals = NormalResiduals(current, surface, base, heights, pool);
    const double scale = options.loss_scale.value_or(RobustScale(residuals));
    current = current.WithWeights(original.cwiseProduct(LossWeights(loss, residuals, scale)));
    RoundSummary summary;
    summary.stage = "robust";
    summary.control_points_u = current.basis_u().size();
    summary.control_points_v = current.basis_v().size();
    summary.rms = std::sqrt(residuals.squaredNorm() / static_cast<double>(residuals.size()));
    summary.max = residuals.cwiseAbs().maxCoeff();
    summary.score = scale;
    summary.seconds = watch.Lap();
    report.iterations.push_back(summary);
    const bool steady = std::abs(scale - previous) <= 2e-3 * scale;
    previous = scale;
    if (steady) {
      if (!start) break;
      round = std::max(round, kHuberRounds - 1);
    }
  }
  return current;
}

// The coarsest uniform grid up to the chosen one that keeps the tolerance, else the chosen one.
FittingProblem CoarsestWithin(const FittingProblem& chosen,
                              const PlaneBase& base,
                              const Eigen::Matrix3Xd& points,
                              const SurfaceFitOptions& options,
                              ThreadPool& pool,
                              const FitReport& report) {
  for (const RoundSummary& round : report.iterations) {
    const int cells_u = round.control_points_u - options.degree_u;
    const int cells_v = round.control_points_v - options.degree_v;
    if (round.stage != "cross-validation" || round.rms > *options.tolerance) continue;
    if (round.control_points_u * round.control_points_v >= chosen.unknowns()) break;
    FittingProblem coarse = chosen.WithBases(
        FittingBasis(options.degree_u, cells_u, chosen.basis_u().lower(), chosen.basis_u().upper()),
        FittingBasis(
            options.degree_v, cells_v, chosen.basis_v().lower(), chosen.basis_v().upper()));
    const NurbsSurface surface = HeightSurface(
        base, coarse.basis_u(), coarse.basis_v(), SolveLinear(coarse, pool).coefficients);
    const PointDistances found =
        DistancesFrom(surface, points, coarse.data().parameters.leftCols(points.cols()), pool);
    if (found.distances.cwiseAbs().maxCoeff() <= *options.tolerance) return coarse;
  }
  return chosen;
}

// Whether the joint stage is to run, and the sentence that says why.
bool JointStagePays(const SurfaceFitOptions& options,
                    double rms,
                    double noise,
                    Eigen::Index points,
                    int unknowns,
                    OptimizeSummary& summary) {
  if (options.optimize == OptimizeMode::kNone) {
    summary.why = "not asked for";
    return false;
  }
  if (options.optimize == OptimizeMode::kParams) {
    summary.why = "asked for";
    return true;
  }
  if (!(noise > 0) || rms <= kExcessToOptimise * noise) {
    summary.why = "residuals are at the noise";
    return false;
  }
  if (static_cast<double>(points) < kPointsPerFreedomToOptimise * unknowns) {
    summary.why = "residuals exceed the noise, but the points are too few for free parameters";
    return false;
  }
  if (unknowns > kMostToOptimise) {
    summary.why =
        "residuals exceed the noise, but so many control points leave free parameters little to "
        "gain";
    return false;
  }
  summary.why = "residuals exceed the noise";
  return true;
}

// One fit, stage by stage; members are what the stages hand on.
class SurfaceFitter {
 public:
  SurfaceFitter(const PointCloud& cloud, const SurfaceFitOptions& options)
      : cloud_(cloud), options_(options), pool_(options.threads) {
    report_.threads = pool_.threads();
  }

  SurfaceFit Run() {
    Prepare();
    DecideWhoCounts();
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
    prepared_ =
        PrepareCloud(cloud_, {options_.keep_outliers, options_.seed}, pool_, options_.progress);
    const double overlap = prepared_.base.overlap;
    const std::string share = std::to_string(std::lround(100 * overlap)) + " % of places";
    if (overlap > kOverlapToRefuse) {
      throw std::invalid_argument("the points lie over each other in " + share +
                                  " as seen from any side: they are not a height field over a "
                                  "plane, and other bases are not "
                                  "in this version; fit a part of the cloud (--box)");
    }
    if (overlap > kOverlapToWarn) {
      report_.warnings.push_back("the points lie over each other in " + share +
                                 ": a height field goes between the layers there");
    }
    report_.input = Summary();
    report_.seconds.parameterize = prepared_.base_seconds;
    report_.seconds.prepare = watch_.Lap() - prepared_.base_seconds;
  }

  InputSummary Summary() const {
    InputSummary input;
    input.points = cloud_.size();
    input.duplicates = prepared_.merged.duplicates;
    input.spacing = prepared_.statistics.spacing;
    input.noise = prepared_.statistics.noise;
    input.origin = cloud_.origin();
    input.box_min = cloud_.origin() + cloud_.points().rowwise().minCoeff();
    input.box_max = cloud_.origin() + cloud_.points().rowwise().maxCoeff();
    return input;
  }

  // Which points count is decided by their neighbours before there is a surface, then by their
  // distance from it, until the two agree. The bases are chosen anew each time.
  void DecideWhoCounts() {
    const PointCloud& all = prepared_.merged.cloud;
    const FittingProblem everything = MakeProblem(prepared_, all, options_);
    robust_ = options_.loss ? *options_.loss != Loss::kNone
                            : static_cast<double>(prepared_.statistics.outlier_count) >
                                  kOutlierShareForLoss * static_cast<double>(all.size());
    bool settled = false;  // so few points changed sides that the grid can't be far off
    for (int pass = 1; pass <= kOutlierPasses; ++pass) {
      used_ = prepared_.used.all() ? all : all.Subset(prepared_.used);
      const bool search_near =
          settled && (problem_->unknowns() > kLargeGrid || used_.size() > kManyPoints);
      problem_ = ChooseBases(MakeProblem(prepared_, used_, options_),
                             options_,
                             search_near ? &*problem_ : nullptr,
                             pool_,
                             report_);
      if (robust_) problem_ = Reweighted(*problem_, prepared_.base, options_, pool_, report_);
      if (pass == kOutlierPasses || options_.keep_outliers) break;
      const PointMask now = SpokenFor(everything);
      if (!robust_ && !options_.loss && (now != prepared_.used).any() && !now.all()) {
        robust_ = true;  // what stands out from a plain fit has bent it
        continue;
      }
      const Eigen::Index changed = (now != prepared_.used).count();
      if (changed == 0) break;
      settled = static_cast<double>(changed) < kFewChanges * static_cast<double>(now.size());
      prepared_.used = now;
    }
    if (options_.tolerance && robust_ && !options_.loss) {
      // A tolerance is the user's own word on which residuals matter: bounded weights chose the
      // bases only.
      problem_ = MakeProblem(prepared_, used_, options_)
                     .WithBases(problem_->basis_u(), problem_->basis_v());
    }
    report_.seconds.solve = watch_.Lap();
  }

  // The points the present solution speaks for, of all.
  PointMask SpokenFor(const FittingProblem& everything) {
    const NurbsSurface surface = HeightSurface(prepared_.base,
                                               problem_->basis_u(),
                                               problem_->basis_v(),
                                               SolveLinear(*problem_, pool_).coefficients);
    const Eigen::Matrix2Xd& places = everything.data().parameters;
    const Eigen::VectorXd distances =
        DistancesFrom(surface, prepared_.merged.cloud.points(), places, pool_).distances;
    Eigen::VectorXd of_used(used_.size());
    Eigen::Index count = 0;
    for (Eigen::Index k = 0; k < distances.size(); ++k) {
      if (prepared_.used[k]) of_used[count++] = distances[k];
    }
    const double scale = options_.loss_scale.value_or(RobustScale(of_used));
    return CloseEnough(places,
                       distances,
                       std::max({kOutlierInScales * scale,
                                 kLeastScale * prepared_.statistics.spacing,
                                 options_.tolerance.value_or(0)}),
                       prepared_.statistics.spacing,
                       pool_);
  }

  void Refine() {
    if (!options_.control_points) {
      problem_ =
          CoarsestWithin(*problem_, prepared_.base, used_.points(), options_, pool_, report_);
    }
    RefineOptions refine;
    refine.tolerance = *options_.tolerance;
    refine.noise = prepared_.statistics.noise;
    refine.spacing = prepared_.statistics.spacing;
    refine.max_control_points =
        options_.control_points ? problem_->unknowns() : options_.max_control_points;
    RefineResult refined = RefineToTolerance(
        *problem_, prepared_.base, used_.points(), refine, pool_, options_.progress);
    Record(refined.rounds);
    report_.termination = refined.termination;
    surface_ = std::move(refined.surface);
    parameters_ = std::move(refined.parameters);
    WarnOfVoids(refined.empty_share);
    report_.seconds.refine = watch_.Lap();
  }

  void Solve() {
    const CalmResult calm =
        SolveCalmly(*problem_, {prepared_.statistics.spacing, used_.size()}, pool_);
    if (calm.solution.regularised) {
      report_.warnings.push_back(
          "the points do not determine every control point: fairness was raised");
    }
    report_.termination = Termination::kNoiseReached;
    surface_ = HeightSurface(
        prepared_.base, problem_->basis_u(), problem_->basis_v(), calm.solution.coefficients);
    parameters_ = problem_->data().parameters.leftCols(used_.size());
    WarnOfVoids(calm.empty_share);
    report_.seconds.solve += watch_.Lap();
  }

  void OptimiseWhereItPays() {
    const PointDistances before = DistancesFrom(*surface_, used_.points(), parameters_, pool_);
    const double rms =
        std::sqrt(before.distances.squaredNorm() / static_cast<double>(used_.size()));
    report_.seconds.project += watch_.Lap();
    report_.optimize.rms_before = report_.optimize.rms_after = rms;
    if (report_.termination == Termination::kCancelled) return;
    const double noise = prepared_.statistics.noise;
    const int unknowns = surface_->size_u() * surface_->size_v();
    if (!JointStagePays(options_, rms, noise, used_.size(), unknowns, report_.optimize)) return;
    JointOptions joint;
    joint.noise = options_.optimize == OptimizeMode::kAuto ? noise : 0;
    joint.loss = robust_ ? options_.loss.value_or(Loss::kTukey) : Loss::kNone;
    joint.loss_scale = options_.loss_scale.value_or(RobustScale(before.distances));
    joint.progress = options_.progress;
    Eigen::VectorXd weights = problem_->data().weights;
    if (weights.size() > 0) weights.conservativeResize(used_.size());
    JointResult result =
        OptimizeJointly(*surface_, used_.points(), weights, before.parameters, joint, pool_);
    report_.optimize.ran = true;
    report_.optimize.iterations = result.iterations;
    report_.optimize.rms_after = result.rms_after;
    if (!result.note.empty()) report_.optimize.why += "; " + result.note;
    Record(result.rounds);
    if (result.cancelled) report_.termination = Termination::kCancelled;
    surface_ = std::move(result.surface);
    report_.seconds.optimize = watch_.Lap();
  }

  // What is reported is measured on the surface as it is handed out, rounding of far coordinates
  // included.
  SurfaceFit Measure() {
    const Eigen::Vector3d move = cloud_.origin() - options_.shift;
    NurbsSurface written = move.isZero(0) ? *surface_ : surface_->Translated(move);
    const NurbsSurface measured = move.isZero(0) ? *surface_ : written.Translated(-move);
    const PointDistances found = DistancesTo(measured, prepared_.merged.cloud.points(), pool_);
    SurfaceFit fit{std::move(written),
                   Eigen::Matrix2Xd(2, cloud_.size()),
                   Eigen::VectorXd(cloud_.size()),
                   PointMask(cloud_.size()),
                   {}};
    for (Eigen::Index k = 0; k < cloud_.size(); ++k) {
      const Eigen::Index place = prepared_.merged.place[k];
      fit.parameters.col(k) = found.parameters.col(place);
      fit.residuals[k] = found.distances[place];
      fit.outliers[k] = !prepared_.used[place];
    }
    report_.error = Summarise(fit.residuals, options_.tolerance, !fit.outliers);
    report_.error_all = Summarise(fit.residuals, options_.tolerance);
    report_.input.used = report_.error.points;
    report_.input.outliers = fit.outliers.count();
    report_.geometry.kind = "surface";
    report_.geometry.base = "plane";
    report_.geometry.degree = {options_.degree_u, options_.degree_v};
    report_.geometry.control_points = {fit.surface.size_u(), fit.surface.size_v()};
    report_.geometry.rational = fit.surface.rational();
    report_.geometry.closed = {false, false};
    if (options_.tolerance && report_.error_all.out_of_tolerance > report_.error.out_of_tolerance) {
      report_.warnings.push_back(
          std::to_string(report_.error_all.out_of_tolerance - report_.error.out_of_tolerance) +
          " points out of tolerance were set aside as outliers and are not counted (error_all "
          "counts them; "
          "--keep-outliers fits them)");
    }
    if (fit.surface.size_u() * fit.surface.size_v() > report_.input.used) {
      report_.warnings.push_back(
          "there are more control points than points: fairness decides the rest");
    }
    JudgeTermination();
    report_.seconds.project += watch_.Lap();
    report_.seconds.total = total_.Lap();
    fit.report = std::move(report_);
    return fit;
  }

  // The word for how it ended, held against what was measured.
  void JudgeTermination() {
    Termination& termination = report_.termination;
    if (termination == Termination::kCancelled) return;
    if (options_.tolerance) {
      if (report_.error.out_of_tolerance == 0) {
        termination = Termination::kToleranceReached;
      } else if (termination == Termination::kToleranceReached) {
        termination = Termination::kStalled;
      }
      return;
    }
    const double rounding = kExact * (report_.input.box_max - report_.input.box_min).norm();
    if (report_.error.rms <= std::max(kExcessToSayNoise * prepared_.statistics.noise, rounding))
      return;
    if (options_.control_points) {
      termination = Termination::kMaxControlPoints;
      return;
    }
    termination = Termination::kStalled;
    if (!(prepared_.statistics.noise > 0)) return;
    report_.warnings.push_back(
        "residuals are well above the noise of neighbouring points, but more control points would "
        "not "
        "predict left-out points better: the shape has edges, layers or detail that a smooth "
        "height "
        "field does not follow");
  }

  void WarnOfVoids(double share) {
    if (share <= kVoidShareToWarn) return;
    report_.warnings.push_back("there are no points in " +
                               std::to_string(std::lround(100 * share)) +
                               " % of the surface's rectangle: the surface is a guess there");
  }

  void Record(const std::vector<RoundSummary>& rounds) {
    report_.iterations.insert(report_.iterations.end(), rounds.begin(), rounds.end());
  }

  const PointCloud& cloud_;
  const SurfaceFitOptions& options_;
  ThreadPool pool_;
  Stopwatch watch_, total_;
  FitReport report_;
  PreparedCloud prepared_;
  PointCloud used_;      // the merged points that count
  bool robust_ = false;  // losses bound residuals
  std::optional<FittingProblem>
      problem_;                          // heights of used points over the base, with chosen bases
  std::optional<NurbsSurface> surface_;  // in the cloud's local coordinates
  Eigen::Matrix2Xd parameters_;          // of used points
};

}  // namespace

void Check(const SurfaceFitOptions& options) {
  const auto reject = [](const std::string& rule) {
    throw std::invalid_argument("SurfaceFitOptions: " + rule);
  };
  for (const auto& [name, degree] :
       {std::pair{"degree_u", options.degree_u}, {"degree_v", options.degree_v}}) {
    if (degree < 1 || degree > kMaxDegree) {
      reject(std::string(name) + " is " + std::to_string(degree) + ", not in [1, " +
             std::to_string(kMaxDegree) + "]");
    }
  }
  if (options.tolerance && !(*options.tolerance > 0 && std::isfinite(*options.tolerance))) {
    reject("tolerance must be positive");
  }
  if (options.control_points) {
    if (options.control_points->first <= options.degree_u ||
        options.control_points->second <= options.degree_v) {
      reject("control_points must exceed the degree in both directions");
    }
    if (std::int64_t{options.control_points->first} * options.control_points->second > 1000000) {
      reject("control_points must not exceed a million in all");
    }
  }
  if (options.max_control_points < (options.degree_u + 1) * (options.degree_v + 1)) {
    reject("max_control_points is below (degree_u + 1)(degree_v + 1), the least a surface has");
  }
  if (options.smoothing && !(*options.smoothing >= 0 && std::isfinite(*options.smoothing))) {
    reject("smoothing must not be negative");
  }
  if (options.loss_scale && !(*options.loss_scale > 0 && std::isfinite(*options.loss_scale))) {
    reject("loss_scale must be positive");
  }
  if (!options.shift.allFinite()) reject("shift must be finite");
}

SurfaceFit FitSurface(const PointCloud& cloud, const SurfaceFitOptions& options) {
  Check(options);
  return SurfaceFitter(cloud, options).Run();
}

}  // namespace batten
