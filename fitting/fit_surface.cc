// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>

#include "batten/fitting/distances.h"
#include "batten/fitting/fit_surface_given.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/grid_selection.h"
#include "batten/fitting/height_field.h"
#include "batten/fitting/neighbours.h"
#include "batten/fitting/plane_base.h"
#include "batten/fitting/refine.h"
#include "batten/fitting/reweighting.h"
#include "batten/fitting/stopwatch.h"
#include "batten/fitting/strangers.h"
#include "batten/fitting/surface_outcome.h"
#include "batten/fitting/surface_preparation.h"
#include "batten/fitting/voids.h"

namespace batten {
namespace {

constexpr double kSmoothing = 1e-4;
constexpr double kOutlierShareForLoss =
    2e-3;  // less is what the test for outliers flags on clean data
constexpr double kOverlapToWarn = 0.02;
constexpr double kOverlapToRefuse = 0.15;
constexpr double kExplains = 0.1;           // share of the misfit that a feature leaves
constexpr double kLeastScale = 1e-3;        // of the spacing: what exact points may be off by
constexpr double kOutlierInScales = 4.685;  // where Tukey's loss stops counting a point
constexpr double kVoidShareToWarn = 0.05;
constexpr int kOutlierPasses = 5;
constexpr double kFewChanges = 0.01;
constexpr int kLargeGrid = 1500;              // searching its size anew takes long …
constexpr Eigen::Index kManyPoints = 200000;  // … as it does with many points

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

// One fit, stage by stage; members are what the stages hand on.
class SurfaceFitter {
 public:
  // Over a base of its own choice, or over the one given.
  SurfaceFitter(const PointCloud& cloud,
                const SurfaceFitOptions& options,
                std::optional<PlaneBase> base = std::nullopt)
      : cloud_(cloud), options_(options), given_base_(std::move(base)), pool_(options.threads) {
    report_.threads = pool_.threads();
  }

  // After Run(): whether points were set aside or bounded by a loss of the fitter's own choice.
  bool doubted_points() const {
    return !options_.loss && !options_.keep_outliers && (robust_ || !prepared_.used.all());
  }
  const PlaneBase& base() const { return prepared_.base; }

  SurfaceFit Run() {
    Prepare();
    DecideWhoCounts();
    if (options_.tolerance) {
      Refine();
    } else {
      Solve();
    }
    Eigen::VectorXd weights = problem_->data().weights;
    if (weights.size() > 0) weights.conservativeResize(used_.size());
    SurfaceDraft draft{std::move(*surface_),
                       std::move(used_),
                       std::move(parameters_),
                       std::move(weights),
                       robust_};
    OptimiseWhereItPays(draft, options_, pool_, watch_, report_);
    SurfaceFit fit = MeasureFit(draft.surface,
                                cloud_,
                                prepared_.merged,
                                prepared_.used,
                                options_,
                                "a smooth height field",
                                pool_,
                                std::move(report_));
    fit.report.geometry.base = "plane";
    fit.report.seconds.project += watch_.Lap();
    fit.report.seconds.total = total_.Lap();
    return fit;
  }

 private:
  void Prepare() {
    prepared_ =
        PrepareCloud(cloud_, {options_.keep_outliers, options_.seed}, pool_, options_.progress);
    if (given_base_) prepared_.base = *given_base_;
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
    report_.input = SummariseInput(cloud_, prepared_.merged.duplicates, prepared_.statistics);
    report_.seconds.parameterize = prepared_.base_seconds;
    report_.seconds.prepare = watch_.Lap() - prepared_.base_seconds;
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
      if (robust_) Reweight();
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

  void Reweight() {
    const auto residuals = [&](const FittingProblem& problem, const LinearSolution& solution) {
      return NormalResiduals(
          problem,
          HeightSurface(
              prepared_.base, problem.basis_u(), problem.basis_v(), solution.coefficients),
          prepared_.base,
          EvaluateAt(problem, solution.coefficients, pool_),
          pool_);
    };
    problem_ =
        Reweighted(*problem_,
                   {options_.loss.value_or(Loss::kTukey), options_.loss_scale, options_.progress},
                   residuals,
                   pool_,
                   report_.iterations);
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
        *problem_, &prepared_.base, used_.points(), refine, pool_, options_.progress);
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
  std::optional<PlaneBase> given_base_;
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

// Of a fit that set points aside and one of all points: what stands out of equal knots may be a
// narrow feature, which free knots follow; outliers nothing follows.
SurfaceFit Explained(SurfaceFit without, SurfaceFit with_all) {
  if (!(with_all.report.error_all.rms < kExplains * without.report.error_all.rms)) return without;
  with_all.report.warnings.push_back(
      "points that stand out of a shape with equal knots were kept: free knots follow them");
  return with_all;
}

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
  if (options.given_parameters) return FitSurfaceAtParameters(cloud, options);
  SurfaceFitter fitter(cloud, options);
  SurfaceFit fit = fitter.Run();
  if (!fitter.doubted_points() || !options.optimize || !options.optimize->knots) return fit;
  SurfaceFitOptions all = options;
  all.keep_outliers = true;
  return Explained(std::move(fit), SurfaceFitter(cloud, all, fitter.base()).Run());
}

}  // namespace batten
