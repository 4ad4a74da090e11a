// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_surface_given.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "batten/fitting/distances.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/grid_selection.h"
#include "batten/fitting/neighbours.h"
#include "batten/fitting/refine.h"
#include "batten/fitting/reweighting.h"
#include "batten/fitting/strangers.h"
#include "batten/fitting/surface_outcome.h"
#include "batten/geometry/knot_vectors.h"

namespace batten {
namespace {

constexpr double kSmoothing = 1e-4;
constexpr double kOutlierShareForLoss = 2e-3;  // less is what the test flags on clean data
constexpr double kOutlierInScales = 4.685;     // where Tukey's loss stops counting a point
constexpr double kLeastScale = 1e-3;           // of the spacing: what exact points may be off by
constexpr int kOutlierPasses = 4;
constexpr double kNarrowestRange = 1e-12;  // of the parameters' size: room for knots between them
constexpr double kLineSquared = 1e-13;  // share of the spread across a line: rounding of the sums
constexpr double kLeastSize = 1e-100;   // squares of smaller numbers vanish
constexpr int kScalingDegree = 3, kScalingSpans = 2;
constexpr double kFlattest = 1e-3;  // ratio of lengths beyond which scaling gives up

// The parameters of one direction: their range, and the length that it is given inside.
struct Side {
  double low = 0, high = 0, length = 1;

  // From the user's parameter to a length; both ends are met exactly.
  double Inside(double parameter) const {
    return std::clamp((parameter - low) / (high - low), 0.0, 1.0) * length;
  }
};

Side RangeOf(const Eigen::RowVectorXd& parameters, const char* name) {
  const Side side{parameters.minCoeff(), parameters.maxCoeff()};
  if (!(side.high > side.low)) {
    throw std::invalid_argument(std::string("the given parameters ") + name +
                                " are all equal: a surface needs columns u and v");
  }
  if (!(side.high - side.low >
        kNarrowestRange * std::max(std::abs(side.low), std::abs(side.high)))) {
    throw std::invalid_argument(std::string("the given parameters ") + name +
                                " hardly differ against their size: subtract an origin from them");
  }
  return side;
}

void RequireSheet(const Eigen::Matrix3Xd& points) {
  if (points.cols() < 4) {
    throw std::invalid_argument("a surface needs at least 4 different points; there are " +
                                std::to_string(points.cols()));
  }
  const Eigen::Vector3d middle = points.rowwise().mean();
  const double size = (points.colwise() - middle).cwiseAbs().maxCoeff();
  if (size < kLeastSize) {
    throw std::invalid_argument("the points differ by less than 1e-100: scale them up");
  }
  const Eigen::Matrix3Xd unit = (points.colwise() - middle) / size;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spread(unit * unit.transpose());
  if (!(spread.eigenvalues()[1] > kLineSquared * spread.eigenvalues()[2])) {
    throw std::invalid_argument("the points lie on a line: they don't carry a surface");
  }
}

// Points that agree in place are one, provided they agree in their parameters too.
MergedCloud MergeEqual(const PointCloud& cloud, const MergedCloud& places) {
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    const Eigen::Index place = places.place[static_cast<size_t>(k)];
    if (cloud.parameters().col(k) == places.cloud.parameters().col(place)) continue;
    MergedCloud all{cloud, 0, std::vector<Eigen::Index>(static_cast<size_t>(cloud.size()))};
    std::iota(all.place.begin(), all.place.end(), Eigen::Index{0});
    return all;
  }
  return places;
}

Eigen::VectorXd Offsets(const FittingProblem& problem,
                        const LinearSolution& solution,
                        ThreadPool& pool) {
  return (EvaluateAt(problem, solution.coefficients, pool) - problem.data().values)
      .colwise()
      .norm();
}

class GivenFitter {
 public:
  GivenFitter(const PointCloud& cloud, const SurfaceFitOptions& options)
      : cloud_(cloud), options_(options), pool_(options.threads) {
    report_.threads = pool_.threads();
  }

  SurfaceFit Run() {
    Prepare();
    ScaleParameters();
    DecideWhoCounts();
    if (options_.tolerance) {
      Refine();
    } else {
      Solve();
    }
    SurfaceDraft draft{std::move(*surface_),
                       used_cloud_,
                       problem_->data().parameters,
                       problem_->data().weights,
                       robust_};
    OptimiseWhereItPays(draft, options_, pool_, watch_, report_);
    return Measure(draft.surface);
  }

 private:
  void Prepare() {
    Report(options_.progress, "prepare", 0);
    if (cloud_.size() == 0) throw std::invalid_argument("the cloud holds no points");
    if (cloud_.parameters().cols() == 0) {
      throw std::invalid_argument("the points have no parameters u and v");
    }
    u_ = RangeOf(cloud_.parameters().row(0), "u");
    v_ = RangeOf(cloud_.parameters().row(1), "v");
    const MergedCloud places = MergeDuplicates(cloud_);
    RequireSheet(places.cloud.points());
    CloudStatisticsOptions statistics;
    statistics.seed = options_.seed;
    statistics.find_outliers = !options_.keep_outliers;
    statistics_ = MeasureCloud(places.cloud.points(),
                               NeighbourIndex(places.cloud.points()),
                               statistics,
                               pool_,
                               options_.progress);
    merged_ = MergeEqual(cloud_, places);
    used_ = PointMask::Constant(merged_.cloud.size(), true);
    for (Eigen::Index k = 0; k < cloud_.size(); ++k) {
      const auto at = static_cast<size_t>(k);
      used_[merged_.place[at]] = !statistics_.outliers[places.place[at]];
    }
    report_.input = SummariseInput(cloud_, merged_.duplicates, statistics_);
    report_.seconds.prepare = watch_.Lap();
  }

  // The problem of the points under a mask, over one span a direction.
  FittingProblem MakeProblem(const PointCloud& points, double smoothing) const {
    auto data = std::make_shared<FittingData>();
    data->parameters.resize(2, points.size());
    for (Eigen::Index k = 0; k < points.size(); ++k) {
      data->parameters.col(k) << u_.Inside(points.parameters()(0, k)),
          v_.Inside(points.parameters()(1, k));
    }
    data->values = points.points();
    if (points.weights().size() > 0) data->weights = points.weights() / points.weights().mean();
    return FittingProblem(
        SplineBasis::Uniform(options_.degree_u, options_.degree_u + 1, 0, u_.length),
        SplineBasis::Uniform(options_.degree_v, options_.degree_v + 1, 0, v_.length),
        std::move(data),
        smoothing);
  }

  FittingProblem WithCells(const FittingProblem& problem, int cells_u, int cells_v) const {
    const int p = problem.basis_u().degree(), q = problem.basis_v().degree();
    return problem.WithBases(SplineBasis::Uniform(p, p + cells_u, 0, u_.length),
                             SplineBasis::Uniform(q, q + cells_v, 0, v_.length));
  }

  // The lengths of the sides: means of |S_u| and |S_v| over the points, on a coarse fit.
  void ScaleParameters() {
    const PointCloud points = merged_.cloud.Subset(used_);
    const FittingProblem start = MakeProblem(points, kSmoothing);
    const int p = std::min(kScalingDegree, options_.degree_u),
              q = std::min(kScalingDegree, options_.degree_v);
    const FittingProblem coarse = start.WithBases(SplineBasis::Uniform(p, p + kScalingSpans, 0, 1),
                                                  SplineBasis::Uniform(q, q + kScalingSpans, 0, 1));
    const NurbsSurface surface(
        coarse.basis_u(), coarse.basis_v(), SolveLinear(coarse, pool_).coefficients);
    double along_u = 0, along_v = 0;
    const Eigen::Matrix2Xd& parameters = coarse.data().parameters;
    for (Eigen::Index k = 0; k < coarse.size(); ++k) {
      const SurfaceJet jet = surface.JetAt(parameters(0, k), parameters(1, k));
      along_u += jet.du.norm();
      along_v += jet.dv.norm();
    }
    const double least = kFlattest * std::max(along_u, along_v);
    const auto count = static_cast<double>(coarse.size());
    u_.length = std::max(along_u, least) / count;
    v_.length = std::max(along_v, least) / count;
    report_.seconds.parameterize = watch_.Lap();
  }

  FittingProblem ChooseBases(const FittingProblem& problem) {
    if (options_.control_points) {
      return WithCells(problem,
                       options_.control_points->first - options_.degree_u,
                       options_.control_points->second - options_.degree_v);
    }
    GridLimits limits;
    limits.degree_u = options_.degree_u;
    limits.degree_v = options_.degree_v;
    limits.max_control_points = options_.max_control_points;
    const GridChoice choice = ChooseGrid(problem, limits, pool_, options_.progress);
    Record(choice.rounds);
    return WithCells(problem, choice.cells_u, choice.cells_v);
  }

  // Which points count is decided by their neighbours before there is a surface, then by their
  // distance from it, until the two agree. The bases are chosen anew each time.
  void DecideWhoCounts() {
    const double smoothing = options_.smoothing.value_or(kSmoothing);
    const FittingProblem everything = MakeProblem(merged_.cloud, smoothing);
    robust_ = options_.loss ? *options_.loss != Loss::kNone
                            : static_cast<double>(statistics_.outlier_count) >
                                  kOutlierShareForLoss * static_cast<double>(merged_.cloud.size());
    for (int pass = 1;; ++pass) {
      used_cloud_ = used_.all() ? merged_.cloud : merged_.cloud.Subset(used_);
      problem_ = ChooseBases(MakeProblem(used_cloud_, smoothing));
      if (robust_) {
        problem_ = Reweighted(
            *problem_,
            {options_.loss.value_or(Loss::kTukey), options_.loss_scale, options_.progress},
            [&](const auto& problem, const auto& solution) {
              return Offsets(problem, solution, pool_);
            },
            pool_,
            report_.iterations);
      }
      if (pass == kOutlierPasses || options_.keep_outliers) break;
      const PointMask now = SpokenFor(everything);
      if ((now == used_).all() || now.count() < 4) break;
      used_ = now;
    }
    if (options_.tolerance && robust_ && !options_.loss) {
      // A tolerance is the user's own word on which residuals matter: bounded weights chose the
      // bases only.
      problem_ =
          MakeProblem(used_cloud_, smoothing).WithBases(problem_->basis_u(), problem_->basis_v());
    }
    report_.seconds.solve = watch_.Lap();
  }

  // The points the present solution speaks for, of all.
  PointMask SpokenFor(const FittingProblem& everything) {
    const NurbsSurface surface(
        problem_->basis_u(), problem_->basis_v(), SolveLinear(*problem_, pool_).coefficients);
    const Eigen::Matrix2Xd& places = everything.data().parameters;
    const Eigen::VectorXd distances =
        DistancesFrom(surface, merged_.cloud.points(), places, pool_).distances;
    Eigen::VectorXd of_used(used_cloud_.size());
    Eigen::Index count = 0;
    for (Eigen::Index k = 0; k < distances.size(); ++k) {
      if (used_[k]) of_used[count++] = distances[k];
    }
    const double scale = options_.loss_scale.value_or(RobustScale(of_used));
    return CloseEnough(places,
                       distances,
                       std::max({kOutlierInScales * scale,
                                 kLeastScale * statistics_.spacing,
                                 options_.tolerance.value_or(0)}),
                       statistics_.spacing,
                       pool_);
  }

  void Solve() {
    const LinearSolution solution = SolveLinear(*problem_, pool_);
    if (solution.regularised) {
      report_.warnings.push_back(
          "the points do not determine every control point: fairness was raised");
    }
    report_.termination = Termination::kNoiseReached;
    surface_ = NurbsSurface(problem_->basis_u(), problem_->basis_v(), solution.coefficients);
    report_.seconds.solve += watch_.Lap();
  }

  // The coarsest grid that cross-validation has tried, up to the one it chose, that keeps the
  // tolerance; else the chosen one.
  FittingProblem CoarsestWithin() {
    for (const RoundSummary& round : report_.iterations) {
      if (round.stage != "cross-validation" || round.rms > *options_.tolerance) continue;
      if (round.control_points_u * round.control_points_v >= problem_->unknowns()) continue;
      FittingProblem coarse = WithCells(*problem_,
                                        round.control_points_u - options_.degree_u,
                                        round.control_points_v - options_.degree_v);
      const NurbsSurface surface(
          coarse.basis_u(), coarse.basis_v(), SolveLinear(coarse, pool_).coefficients);
      const PointDistances found =
          DistancesFrom(surface, used_cloud_.points(), coarse.data().parameters, pool_);
      if (found.distances.cwiseAbs().maxCoeff() <= *options_.tolerance) return coarse;
    }
    return *problem_;
  }

  void Refine() {
    if (!options_.control_points) problem_ = CoarsestWithin();
    RefineOptions refine;
    refine.tolerance = *options_.tolerance;
    refine.noise = statistics_.noise;
    refine.spacing = statistics_.spacing;
    refine.max_control_points =
        options_.control_points ? problem_->unknowns() : options_.max_control_points;
    RefineResult refined = RefineToTolerance(
        *problem_, nullptr, used_cloud_.points(), refine, pool_, options_.progress);
    Record(refined.rounds);
    report_.termination = refined.termination;
    surface_ = std::move(refined.surface);
    report_.seconds.refine = watch_.Lap();
  }

  SurfaceFit Measure(const NurbsSurface& surface) {
    const NurbsSurface in_users_units(Scaled(surface.basis_u(), u_.low, u_.high),
                                      Scaled(surface.basis_v(), v_.low, v_.high),
                                      surface.control_points(),
                                      surface.weights());
    SurfaceFit fit = MeasureFit(in_users_units,
                                cloud_,
                                merged_,
                                used_,
                                options_,
                                "a smooth surface over the given parameters",
                                pool_,
                                std::move(report_));
    const bool kept =
        !fit.report.optimize.ran || (options_.optimize && !options_.optimize->parameters);
    if (kept) fit.report.parameter_error = AtParameters(fit);
    fit.report.geometry.base = "given";
    fit.report.seconds.project += watch_.Lap();
    fit.report.seconds.total = total_.Lap();
    return fit;
  }

  // Distances of the used points from the surface at their own parameters.
  ErrorSummary AtParameters(const SurfaceFit& fit) const {
    const Eigen::Vector3d move = cloud_.origin() - options_.shift;
    Eigen::VectorXd offsets(cloud_.size());
    for (Eigen::Index k = 0; k < cloud_.size(); ++k) {
      const auto at = cloud_.parameters().col(k);
      offsets[k] = (fit.surface.At(at[0], at[1]) - move - cloud_.points().col(k)).norm();
    }
    return Summarise(offsets, options_.tolerance, !fit.outliers);
  }

  void Record(const std::vector<RoundSummary>& rounds) {
    report_.iterations.insert(report_.iterations.end(), rounds.begin(), rounds.end());
  }

  const PointCloud& cloud_;
  const SurfaceFitOptions& options_;
  ThreadPool pool_;
  Stopwatch watch_, total_;
  FitReport report_;
  Side u_, v_;
  CloudStatistics statistics_;
  MergedCloud merged_;
  PointMask used_;                         // of the merged points: those the fit rests on
  PointCloud used_cloud_;                  // they
  bool robust_ = false;                    // losses bound residuals
  std::optional<FittingProblem> problem_;  // their places at their parameters, as lengths
  std::optional<NurbsSurface> surface_;    // over those, in the cloud's local coordinates
};

}  // namespace

SurfaceFit FitSurfaceAtParameters(const PointCloud& cloud, const SurfaceFitOptions& options) {
  return GivenFitter(cloud, options).Run();
}

}  // namespace batten
