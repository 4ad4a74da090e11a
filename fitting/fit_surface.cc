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
#include "batten/fitting/statistics.h"
#include "batten/fitting/voids.h"

namespace batten {
namespace {

constexpr double kSmoothing = 1e-4;
constexpr double kOutlierShareForLoss =
    2e-3;  // less is what the test for outliers flags on clean data
constexpr double kOverlapToWarn = 0.02;
constexpr double kOverlapToRefuse = 0.15;
constexpr double kOutlierInScales = 4.685;  // where Tukey's loss stops counting a point
constexpr double kVoidShareToWarn = 0.05;
constexpr int kOutlierPasses = 5;
constexpr double kFewChanges = 0.01;
constexpr int kLargeGrid = 1500;              // searching its size anew takes long …
constexpr Eigen::Index kManyPoints = 200000;  // … as it does with many points
constexpr double kStructureInSpacings = 4;    // what a surface may miss between points
constexpr int kWitnesses = 8;                 // neighbours asked whether a point is alone
constexpr int kWitnessesNeeded = 3;           // that are off as it is
constexpr double kAlike = 2;                  // within this factor of its distance
constexpr double kFlatTail = 0.6;
constexpr int kHuberRounds = 8, kTukeyRounds = 8;
constexpr double kExcessToOptimise = 1.2;  // residual against noise
constexpr double kExcessToSayNoise = 2;
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

// The cloud as the later stages see it.
struct Prepared {
  MergedCloud merged;
  CloudStatistics statistics;
  PlaneBase base;
  PointMask used;  // of the merged points
};

InputSummary Summary(const PointCloud& cloud, const Prepared& prepared) {
  InputSummary input;
  input.points = cloud.size();
  input.duplicates = prepared.merged.duplicates;
  input.spacing = prepared.statistics.spacing;
  input.noise = prepared.statistics.noise;
  input.origin = cloud.origin();
  input.box_min = cloud.origin() + cloud.points().rowwise().minCoeff();
  input.box_max = cloud.origin() + cloud.points().rowwise().maxCoeff();
  return input;
}

// Puts points that are neighbours in the plane beside each other in memory: everything later goes
// through them cell by cell.
void SortByPlace(Prepared& prepared) {
  const PointCloud& cloud = prepared.merged.cloud;
  const Eigen::Matrix3Xd local = prepared.base.ToFrame(cloud.points());
  constexpr double kPointsPerPlace = 16;
  const double side = std::sqrt(prepared.base.length_u * prepared.base.length_v * kPointsPerPlace /
                                static_cast<double>(cloud.size()));
  const auto columns = static_cast<Eigen::Index>(prepared.base.length_v / side) + 1;
  std::vector<std::pair<Eigen::Index, Eigen::Index>> keys(static_cast<size_t>(cloud.size()));
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(std::max(0.0, local(0, k)) / side);
    const auto column =
        std::min(columns - 1, static_cast<Eigen::Index>(std::max(0.0, local(1, k)) / side));
    keys[k] = {row * columns + (row % 2 == 0 ? column : columns - 1 - column), k};
  }
  std::sort(keys.begin(), keys.end());
  std::vector<Eigen::Index> order, rank(keys.size());
  order.reserve(keys.size());
  for (const auto& [key, k] : keys) {
    rank[k] = static_cast<Eigen::Index>(order.size());
    order.push_back(k);
  }
  prepared.merged.cloud = cloud.Picked(order);
  for (Eigen::Index& place : prepared.merged.place) place = rank[place];
  prepared.used = prepared.used(order).eval();
  prepared.statistics.outliers = prepared.statistics.outliers(order).eval();
}

Prepared Prepare(const PointCloud& cloud, const SurfaceFitOptions& options, ThreadPool& pool) {
  Prepared prepared;
  Report(options.progress, "prepare", 0);
  if (cloud.size() == 0) throw std::invalid_argument("the cloud holds no points");
  prepared.merged = MergeDuplicates(cloud);
  const PointCloud& points = prepared.merged.cloud;
  if (points.size() < 4) {
    throw std::invalid_argument("a surface needs at least 4 different points; there are " +
                                std::to_string(points.size()));
  }
  const NeighbourIndex index(points.points());
  CloudStatisticsOptions statistics;
  statistics.seed = options.seed;
  statistics.find_outliers = !options.keep_outliers;
  prepared.statistics = MeasureCloud(points.points(), index, statistics, pool, options.progress);
  prepared.used = !prepared.statistics.outliers;
  Report(options.progress, "parameterize", 0);
  const double margin = prepared.statistics.spacing / 2 + 2 * prepared.statistics.noise;
  const PlaneBaseOptions base_options{.seed = options.seed};
  if (prepared.used.all()) {
    prepared.base =
        FindPlaneBase(points.points(), index, prepared.statistics.spacing, margin, base_options);
  } else {
    const PointCloud good = points.Subset(prepared.used);
    prepared.base = FindPlaneBase(good.points(),
                                  NeighbourIndex(good.points()),
                                  prepared.statistics.spacing,
                                  margin,
                                  base_options);
  }
  SortByPlace(prepared);
  return prepared;
}

// Heights over the base at the merged points that are used; parameters a hair inside the domain.
FittingProblem MakeProblem(const Prepared& prepared,
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

Eigen::VectorXd Where(const Eigen::VectorXd& values, const PointMask& mask) {
  Eigen::VectorXd chosen(mask.count());
  Eigen::Index count = 0;
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    if (mask[k]) chosen[count++] = values[k];
  }
  return chosen;
}

// Where strangers begin: the least doubling of the limit beyond which the tail of the distances is
// flat, most of what exceeds it exceeding even twice as much. Noise and structure the surface has
// missed thin out with distance; outliers do not care. Infinity where the tail thins out all the
// way.
double StrangersBegin(const Eigen::VectorXd& distances, double limit) {
  if (!(limit > 0)) return std::numeric_limits<double>::infinity();
  const double farthest = distances.cwiseAbs().maxCoeff();
  for (double from = limit; from < farthest; from *= 2) {
    const auto beyond = static_cast<double>((distances.array().abs() > from).count());
    const auto far_beyond = static_cast<double>((distances.array().abs() > 2 * from).count());
    if (far_beyond > kFlatTail * beyond) return from;
  }
  return std::numeric_limits<double>::infinity();
}

// Which points a surface speaks for. A far point is an outlier where it is alone with its distance
// among its neighbours in the plane, or farther than structure between points could reach; where
// several of them are off to the same side by as much, the surface is what is wrong, not the point.
PointMask CloseEnough(const Prepared& prepared,
                      const Eigen::Matrix2Xd& parameters,
                      const Eigen::VectorXd& distances,
                      double scale,
                      const SurfaceFitOptions& options,
                      ThreadPool& pool) {
  const double limit =
      StrangersBegin(distances, std::max(kOutlierInScales * scale, options.tolerance.value_or(0)));
  const double reach = std::max(limit, kStructureInSpacings * prepared.statistics.spacing);
  std::vector<Eigen::Index> doubtful;
  for (Eigen::Index k = 0; k < distances.size(); ++k) {
    if (!(std::abs(distances[k]) <= limit)) doubtful.push_back(k);
  }
  PointMask close = PointMask::Constant(distances.size(), true);
  if (doubtful.empty()) return close;
  Eigen::Matrix3Xd plan = Eigen::Matrix3Xd::Zero(3, parameters.cols());
  plan.topRows<2>() = parameters;
  const NeighbourIndex index(plan);
  pool.For(static_cast<std::ptrdiff_t>(doubtful.size()),
           64,
           [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
             for (std::ptrdiff_t i = begin; i < end; ++i) {
               const Eigen::Index k = doubtful[i];
               const double own = distances[k];
               int alike = 0;
               for (const int j : index.Nearest(plan.col(k), kWitnesses + 1)) {
                 const double ratio = distances[j] / own;
                 if (j != k && ratio > 1 / kAlike && ratio < kAlike) ++alike;
               }
               close[k] = std::abs(own) <= reach && alike >= kWitnessesNeeded;
             }
           });
  return close;
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
    const FittingProblem coarse = chosen.WithBases(
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
  ThreadPool pool(options.threads);
  Stopwatch watch, total;
  FitReport report;
  report.threads = pool.threads();

  Prepared prepared = Prepare(cloud, options, pool);
  const PlaneBase& base = prepared.base;
  if (base.overlap > kOverlapToRefuse) {
    throw std::invalid_argument("the points lie over each other in " +
                                std::to_string(std::lround(100 * base.overlap)) +
                                " % of places as seen from any side: they are not a height field "
                                "over a plane, and other bases "
                                "are not in this version; fit a part of the cloud (--box)");
  }
  if (base.overlap > kOverlapToWarn) {
    report.warnings.push_back("the points lie over each other in " +
                              std::to_string(std::lround(100 * base.overlap)) +
                              " % of places: a height field goes between the layers there");
  }
  report.input = Summary(cloud, prepared);
  report.seconds.prepare = watch.Lap();

  // Which points count is decided by their neighbours before there is a surface, then by their
  // distance from it, until the two agree.
  bool robust = options.loss ? *options.loss != Loss::kNone
                             : static_cast<double>(prepared.statistics.outlier_count) >
                                   kOutlierShareForLoss * static_cast<double>(prepared.used.size());
  const FittingProblem everything = MakeProblem(prepared, prepared.merged.cloud, options);
  std::optional<FittingProblem> problem;
  PointCloud used;
  bool settled = false;  // so few points changed sides that the grid can't be far off
  for (int pass = 1; pass <= kOutlierPasses; ++pass) {
    used =
        prepared.used.all() ? prepared.merged.cloud : prepared.merged.cloud.Subset(prepared.used);
    problem = ChooseBases(MakeProblem(prepared, used, options),
                          options,
                          settled && (problem->unknowns() > kLargeGrid || used.size() > kManyPoints)
                              ? &*problem
                              : nullptr,
                          pool,
                          report);
    if (robust) problem = Reweighted(*problem, base, options, pool, report);
    if (pass == kOutlierPasses || options.keep_outliers) break;
    const NurbsSurface surface = HeightSurface(
        base, problem->basis_u(), problem->basis_v(), SolveLinear(*problem, pool).coefficients);
    const PointDistances found =
        DistancesFrom(surface, prepared.merged.cloud.points(), everything.data().parameters, pool);
    const double scale =
        options.loss_scale.value_or(RobustScale(Where(found.distances, prepared.used)));
    const PointMask now =
        CloseEnough(prepared, everything.data().parameters, found.distances, scale, options, pool);
    if (!robust && !options.loss && (now != prepared.used).any() && !now.all()) {
      robust = true;  // what stands out from a plain fit has bent it
      continue;
    }
    const Eigen::Index changed = (now != prepared.used).count();
    if (changed == 0) break;
    settled = static_cast<double>(changed) < kFewChanges * static_cast<double>(now.size());
    prepared.used = now;
  }
  if (options.tolerance && robust && !options.loss) {
    // A tolerance is the user's own word on which residuals matter: bounded weights chose the bases
    // only.
    problem =
        MakeProblem(prepared, used, options).WithBases(problem->basis_u(), problem->basis_v());
  }
  report.seconds.solve = watch.Lap();

  report.termination = Termination::kNoiseReached;
  std::optional<NurbsSurface> surface;
  Eigen::Matrix2Xd parameters;
  double empty_share = 0;
  if (options.tolerance) {
    if (!options.control_points) {
      problem = CoarsestWithin(*problem, base, used.points(), options, pool, report);
    }
    RefineOptions refine;
    refine.tolerance = *options.tolerance;
    refine.noise = prepared.statistics.noise;
    refine.spacing = prepared.statistics.spacing;
    refine.max_control_points =
        options.control_points ? problem->unknowns() : options.max_control_points;
    RefineResult refined =
        RefineToTolerance(*problem, base, used.points(), refine, pool, options.progress);
    report.iterations.insert(report.iterations.end(), refined.rounds.begin(), refined.rounds.end());
    report.termination = refined.termination;
    surface = std::move(refined.surface);
    parameters = std::move(refined.parameters);
    empty_share = refined.empty_share;
    report.seconds.refine = watch.Lap();
  } else {
    const CalmResult calm = SolveCalmly(*problem, {prepared.statistics.spacing, used.size()}, pool);
    empty_share = calm.empty_share;
    const LinearSolution& solution = calm.solution;
    if (solution.regularised) {
      report.warnings.push_back(
          "the points do not determine every control point: fairness was raised");
    }
    surface = HeightSurface(base, problem->basis_u(), problem->basis_v(), solution.coefficients);
    parameters = problem->data().parameters.leftCols(used.size());
    report.seconds.solve += watch.Lap();
  }

  if (empty_share > kVoidShareToWarn) {
    report.warnings.push_back("there are no points in " +
                              std::to_string(std::lround(100 * empty_share)) +
                              " % of the surface's rectangle: the surface is a guess there");
  }

  const PointDistances before = DistancesFrom(*surface, used.points(), parameters, pool);
  const double rms = std::sqrt(before.distances.squaredNorm() / static_cast<double>(used.size()));
  report.seconds.project += watch.Lap();
  report.optimize.rms_before = report.optimize.rms_after = rms;
  const int unknowns = surface->size_u() * surface->size_v();
  if (report.termination != Termination::kCancelled &&
      JointStagePays(
          options, rms, prepared.statistics.noise, used.size(), unknowns, report.optimize)) {
    JointOptions joint;
    joint.noise = options.optimize == OptimizeMode::kAuto ? prepared.statistics.noise : 0;
    joint.loss = robust ? options.loss.value_or(Loss::kTukey) : Loss::kNone;
    joint.loss_scale = options.loss_scale.value_or(RobustScale(before.distances));
    joint.progress = options.progress;
    JointResult optimised = OptimizeJointly(
        *surface,
        used.points(),
        problem->data().weights.head(problem->data().weights.size() > 0 ? used.size() : 0),
        before.parameters,
        joint,
        pool);
    report.optimize.ran = true;
    report.optimize.iterations = optimised.iterations;
    report.optimize.rms_after = optimised.rms_after;
    if (!optimised.note.empty()) report.optimize.why += "; " + optimised.note;
    report.iterations.insert(
        report.iterations.end(), optimised.rounds.begin(), optimised.rounds.end());
    if (optimised.cancelled) report.termination = Termination::kCancelled;
    surface = std::move(optimised.surface);
    report.seconds.optimize = watch.Lap();
  }

  // What is reported is measured on the surface as it is handed out, rounding of far coordinates
  // included.
  const Eigen::Vector3d move = cloud.origin() - options.shift;
  NurbsSurface written = move.isZero(0) ? *surface : surface->Translated(move);
  const NurbsSurface measured = move.isZero(0) ? *surface : written.Translated(-move);
  const PointDistances found = DistancesTo(measured, prepared.merged.cloud.points(), pool);
  SurfaceFit fit{std::move(written),
                 Eigen::Matrix2Xd(2, cloud.size()),
                 Eigen::VectorXd(cloud.size()),
                 PointMask(cloud.size()),
                 {}};
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    const Eigen::Index place = prepared.merged.place[k];
    fit.parameters.col(k) = found.parameters.col(place);
    fit.residuals[k] = found.distances[place];
    fit.outliers[k] = !prepared.used[place];
  }
  report.error = Summarise(fit.residuals, options.tolerance, !fit.outliers);
  report.error_all = Summarise(fit.residuals, options.tolerance);
  report.input.used = report.error.points;
  report.input.outliers = fit.outliers.count();
  if (!options.tolerance && report.termination != Termination::kCancelled &&
      report.error.rms > kExcessToSayNoise * prepared.statistics.noise) {
    report.termination =
        options.control_points ? Termination::kMaxControlPoints : Termination::kStalled;
    if (!options.control_points) {
      report.warnings.push_back(
          "residuals are well above the noise of neighbouring points, but more control "
          "points would not predict left-out points better: the shape has edges, layers or "
          "detail that a smooth height field does not follow");
    }
  }
  if (options.tolerance && report.termination != Termination::kCancelled) {
    if (report.error.out_of_tolerance == 0) {
      report.termination = Termination::kToleranceReached;
    } else if (report.termination == Termination::kToleranceReached) {
      report.termination = Termination::kStalled;
    }
  }
  report.geometry.kind = "surface";
  report.geometry.base = "plane";
  report.geometry.degree = {options.degree_u, options.degree_v};
  report.geometry.control_points = {fit.surface.size_u(), fit.surface.size_v()};
  report.geometry.rational = fit.surface.rational();
  report.geometry.closed = {false, false};
  report.seconds.project += watch.Lap();
  report.seconds.total = total.Lap();
  fit.report = std::move(report);
  return fit;
}

}  // namespace batten
