// SPDX-License-Identifier: MIT
#include "fitting/surface/surface_measurement.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/distances.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/optimize.h"
#include "batten/geometry/closure.h"
#include "fitting/core/box_excursion.h"
#include "fitting/core/fit_end.h"
#include "fitting/core/mask_indices.h"
#include "fitting/core/rounding.h"
#include "fitting/core/rules.h"
#include "fitting/core/shared_constants.h"
#include "fitting/joint/moved_terms.h"
#include "fitting/least_squares/residual_structure.h"
#include "fitting/surface/data_box.h"
#include "fitting/surface/surface_folds.h"
#include "fitting/surface/surface_overshoot.h"
#include "geometry/numeric/number_text.h"

namespace batten::internal {
namespace {

constexpr double kSmoothingOfFreeKnots = 1e-7;
constexpr double kFewPoints = 12;  // to a control point
constexpr double kFirmFairness = 1e-4, kFaintFairness = 1e-6;
constexpr double kFairnessToHold = 0.1, kStepOfHolding = 100;
constexpr double kExcessToOptimise = 1.2;  // residual over noise; above: joint optimization pays
constexpr double kFollowsNoise = 0.8;      // residuals over noise; below: a warning of overfitting
constexpr double kStructured = 0.15;  // share of the residuals' variance that is smooth in a cell
constexpr double kPointsPerFreedomToOptimise = 2.5;
constexpr int kMostToOptimise = 1500;
constexpr double kEmptyToWarn = 0.05;  // share of the area

// The user's terms for the surface so far, in the coordinates of the cloud, whose origin is given.
ResidualTerms TermsOf(const SurfaceFitOptions& options,
                      const NurbsSurface& surface,
                      const Eigen::Vector3d& origin) {
  const Eigen::Vector3d move = origin - options.shift;
  return MovedTerms(options.terms(surface.Translated(move)), move);
}

// Decides whether the joint stage runs, and says why.
bool JointOptimizationReducesError(const SurfaceFitOptions& options,
                                   const SurfaceState& draft,
                                   const Eigen::VectorXd& distances,
                                   ThreadPool& pool,
                                   double rms,
                                   double noise,
                                   Eigen::Index points,
                                   int unknowns,
                                   OptimizeSummary& summary) {
  if (options.optimize && !options.optimize->any()) {
    summary.why = "not asked for";
    return false;
  }
  if (options.terms) {
    summary.why = "the user's terms ask for it";
    return true;
  }
  if (options.optimize) {
    summary.why = points < unknowns ? "asked for, but there are more control points than points"
                                    : "asked for";
    return points >= unknowns;
  }
  if (!Acts(Rule::kJointStage) || !(noise > 0) || rms <= kExcessToOptimise * noise) {
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
  const bool missed = options.tolerance && distances.cwiseAbs().maxCoeff() > *options.tolerance;
  const double structured =
      StructuredShare({draft.parameters, distances, options.seed}, unknowns, pool);
  if (Acts(Rule::kStructuredGate) && !missed && rms <= kSharedAtMost * noise &&
      (draft.noise_is_shared || structured < kStructured)) {
    summary.why =
        "residuals exceed the noise of nearest neighbours, but they are no shape that "
        "could be followed: neighbouring points share their noise";
    return false;
  }
  summary.why = "residuals exceed the noise";
  return true;
}

// The size of residuals due to rounding of the coordinates alone.
double RoundingOf(const InputSummary& input) {
  return kRelativelyEqual * (input.box_max - input.box_min).norm();
}

// Adds warnings where the user's options conflict with the noise of the points.
void WarnOfNoise(const SurfaceFitOptions& options, FitReport& report) {
  const double noise = report.input.noise;
  if (options.tolerance && *options.tolerance < noise && report.error.out_of_tolerance > 0) {
    report.warnings.push_back(
        "the tolerance is below the noise of the points: a surface that kept it would follow the "
        "noise");
  }
  if (options.control_points && report.error.rms < kFollowsNoise * noise) {
    report.warnings.push_back(
        "residuals are well below the noise of neighbouring points: so many control points follow "
        "the noise");
  }
}

// Whether neighbours share the residuals of the used points.
bool HasStructure(const SurfaceFit& fit, const SurfaceFitOptions& options, ThreadPool& pool) {
  constexpr Eigen::Index kPlaces = 400;  // enough for mean lengths of S_u and S_v
  const std::vector<Eigen::Index> used = IndicesOf(!fit.outliers);
  const auto count = static_cast<Eigen::Index>(used.size());
  const Eigen::Index step = std::max<Eigen::Index>(1, count / kPlaces);
  Eigen::Vector2d stretch = Eigen::Vector2d::Zero();
  for (Eigen::Index k = 0; k < count; k += step) {
    const auto at = fit.parameters.col(used[k]);
    const SurfaceJet jet = fit.surface.JetAt(at[0], at[1]);
    stretch += Eigen::Vector2d(jet.du.norm(), jet.dv.norm());
  }
  stretch *= static_cast<double>(step) / static_cast<double>(std::max<Eigen::Index>(1, count));
  return StructuredShare({stretch.asDiagonal() * fit.parameters(Eigen::all, used),
                          fit.residuals(used),
                          options.seed},
                         fit.surface.size_u() * fit.surface.size_v(),
                         pool) > kStructured;
}

// How the fit ended, by the measured errors.
void Judge(const SurfaceFit& fit,
           const PointCloud& cloud,
           const SurfaceFitOptions& options,
           const std::string& shape,
           ThreadPool& pool,
           FitReport& report) {
  EndEvidence evidence;
  evidence.search = report.end.code;
  evidence.control_points_given = options.control_points.has_value();
  evidence.noise = report.input.noise;
  evidence.rounding = RoundingOf(report.input);
  Eigen::Index farthest = 0;
  fit.outliers.select(0, fit.residuals.array().abs()).maxCoeff(&farthest);
  evidence.farthest = cloud.World(farthest);
  JudgeEnd(evidence, report);
  if (report.leaves_points()) {
    const Eigen::Vector3d& at = report.overshoot->at;
    const double unit = std::pow(10, std::floor(std::log10(report.input.spacing)) - 1);
    const auto text = [&](double x) { return NumberText(std::round(x / unit) * unit); };
    report.warnings.push_back(report.end.words + ": near (" + text(at[0]) + ", " + text(at[1]) +
                              ", " + text(at[2]) + ")");
    return;
  }
  if (report.overshoot->asked_for) {
    report.overshoot->asked_for = false;
    if (report.leaves_points()) {
      report.warnings.push_back("untrimmed, " + WordsOfLeaving(report));
    }
    report.overshoot->asked_for = true;
  }
  if (report.termination != Termination::kStalled) return;
  evidence.structured = HasStructure(fit, options, pool);
  JudgeEnd(evidence, report);
  if (options.tolerance || !(report.input.noise > 0)) return;
  report.warnings.push_back(
      "residuals are well above the noise of neighbouring points, but more control points would "
      "not predict left-out points better: the shape has edges, layers or detail that " +
      shape + " does not follow");
}

// The fairness weight with free parameters. With many points per control point it only smooths
// control points without data; with few it must suppress folds.
double FairnessOfFreePoints(Eigen::Index points, int unknowns) {
  const double share = static_cast<double>(points) / unknowns;
  return share < kFewPoints ? kFirmFairness : kFaintFairness;
}

// Scatters the used points' parameters to columns of all points, NaN for the others.
Eigen::Matrix2Xd PlacesOf(const PointMask& used, const Eigen::Matrix2Xd& of_used) {
  Eigen::Matrix2Xd places = Eigen::Matrix2Xd::Constant(2, used.size(), kNone);
  Eigen::Index next = 0;
  for (Eigen::Index k = 0; k < used.size() && next < of_used.cols(); ++k) {
    if (used[k]) places.col(k) = of_used.col(next++);
  }
  return places;
}

// Fixes the rows at poles: free control points would open the poles, or break their tangent planes.
std::vector<int> PolePoints(const SurfaceState& draft) {
  std::vector<int> held;
  const int size_v = draft.surface.size_v();
  for (int i = 0; i < draft.surface.size_u(); ++i) {
    const int row = i * size_v;
    if (draft.poles.start != PoleKind::kNone) held.insert(held.end(), {row, row + 1});
    if (draft.poles.end != PoleKind::kNone)
      held.insert(held.end(), {row + size_v - 2, row + size_v - 1});
  }
  return held;
}

NurbsSurface SurfaceOf(const OptimizeResult& found) {
  return {found.problem.basis_u(), found.problem.basis_v(), found.control_points, found.weights};
}

void EnterOvershoot(const NurbsSurface& surface,
                    const MergedCloud& merged,
                    const PointMask& used,
                    const Eigen::Matrix2Xd& parameters,
                    ThreadPool& pool,
                    FitReport& report) {
  const std::vector<Eigen::Index> kept = IndicesOf(used);
  const Eigen::Matrix3Xd points = merged.cloud.points()(Eigen::all, kept);
  const Eigen::Matrix2Xd feet = parameters(Eigen::all, kept);
  report.overshoot = MeasureOvershoot(
      {surface, points, feet, report.input.spacing, DirectionOfHeights(report)}, pool);
  const Eigen::Vector3d origin = merged.cloud.origin();
  if (report.overshoot->max > 0) report.overshoot->at += origin;
  if (surface.trimmed() || report.leaves_points()) return;
  Eigen::AlignedBox3d box;
  for (const auto& point : points.colwise()) box.extend(point);
  EnterExcursion(surface, box, origin, report);
}

}  // namespace

void OptimiseWhereItPays(SurfaceState& draft,
                         const SurfaceFitOptions& options,
                         const std::function<std::vector<std::uint8_t>()>& held,
                         ThreadPool& pool,
                         StageClock& clock,
                         FitReport& report) {
  clock.Enter(&StageSeconds::project);
  const PointDistances before =
      DistancesFrom(draft.surface, draft.used.points(), draft.parameters, pool);
  const Eigen::Index points = draft.used.size();
  const double rms = std::sqrt(before.distances.squaredNorm() / static_cast<double>(points));
  clock.Enter(&StageSeconds::optimize);
  report.optimize.rms_before = report.optimize.rms_after = rms;
  if (report.end.code == EndCode::kCancelled) return;
  // The noise of exact points is rounding, far below the errors a joint stage could reduce.
  const double noise =
      report.input.noise > 0 ? std::max(report.input.noise, RoundingOf(report.input)) : 0;
  const int unknowns = draft.surface.size_u() * draft.surface.size_v();
  if (!JointOptimizationReducesError(
          options, draft, before.distances, pool, rms, noise, points, unknowns, report.optimize))
    return;
  OptimizeOptions optimize;
  if (options.optimize) optimize.free = *options.optimize;
  // Knots of a periodic direction stay fixed.
  optimize.knots_u = !draft.surface.basis_u().periodic();
  optimize.knots_v = !draft.surface.basis_v().periodic();
  optimize.free.knots = optimize.free.knots && (optimize.knots_u || optimize.knots_v);
  if (!optimize.free.any() && !options.terms) {
    report.optimize.why = "knots of closed directions stay where they are";
    return;
  }
  // Under a loss an edge can retreat from the outermost points. Where the result is taken whatever
  // it is, as with terms, the outliers that were left out have to do.
  const Loss usual = options.terms ? Loss::kNone : Loss::kTukey;
  optimize.loss = draft.robust ? options.loss.value_or(usual) : Loss::kNone;
  optimize.loss_scale = options.loss_scale.value_or(RobustScale(before.distances));
  optimize.fairness = options.smoothing.value_or(FairnessOfFreePoints(points, unknowns));
  optimize.seed = options.seed;
  optimize.fixed_control_points = PolePoints(draft);
  optimize.progress = options.progress;
  if (options.terms) {
    optimize.terms = TermsOf(options, draft.surface, report.input.origin);
    optimize.stop_at_noise = false;
  }
  auto data = std::make_shared<FittingData>();
  data->parameters = draft.parameters;
  data->values = draft.used.points();
  data->weights = draft.weights;
  optimize.held = held();
  const FittingProblem problem(
      draft.surface.basis_u(),
      draft.surface.basis_v(),
      std::move(data),
      options.smoothing.value_or(optimize.free.knots ? kSmoothingOfFreeKnots : kSurfaceSmoothing));
  const auto optimise = [&] {
    return Optimize(
        problem, draft.surface.control_points(), draft.surface.weights(), optimize, pool);
  };
  const double beyond_before = BeyondBox(draft.surface, draft.used.points());
  const auto leaves_box = [&](const OptimizeResult& found) {
    return BeyondBox(SurfaceOf(found), draft.used.points()) > beyond_before;
  };
  const int folds_before = FoldedPairs(draft.surface);
  const auto folds = [&](const OptimizeResult& found) {
    return FoldedPairs(SurfaceOf(found)) > folds_before;
  };
  OptimizeResult result = optimise();
  // What few data do not determine fairness holds, where it is free.
  while (!options.terms && (leaves_box(result) || folds(result)) && !result.cancelled &&
         !options.smoothing && optimize.fairness < kFairnessToHold) {
    optimize.fairness *= kStepOfHolding;
    result = optimise();
  }
  report.optimize.ran = result.ran;
  report.optimize.iterations = result.iterations;
  if (!result.note.empty()) {
    report.optimize.why = result.ran ? report.optimize.why + "; " + result.note : result.note;
  }
  report.iterations.insert(report.iterations.end(), result.rounds.begin(), result.rounds.end());
  if (result.cancelled) report.end.code = EndCode::kCancelled;
  NurbsSurface optimised = SurfaceOf(result);
  const Eigen::Matrix2Xd& places = result.problem.data().parameters;
  const PointDistances after = DistancesFrom(optimised, draft.used.points(), places, pool);
  const auto keeps_tolerance = [&](const PointDistances& found) {
    return found.distances.cwiseAbs().maxCoeff() <= options.tolerance.value_or(0);
  };
  const double rms_after = std::sqrt(after.distances.squaredNorm() / static_cast<double>(points));
  const auto take = [&] {
    draft.surface = std::move(optimised);
    draft.estimator.freed = optimize.free;
    draft.estimator.smoothing = optimize.fairness;
    report.optimize.rms_after = rms_after;
  };
  if (options.terms) return take();  // which may well lead away from the points
  if (options.tolerance && !options.optimize && keeps_tolerance(before) &&
      !keeps_tolerance(after)) {
    report.optimize.why += "; what it found does not keep the tolerance and was not taken";
    return;
  }
  // An edge can retreat from the outermost points, since a robust loss bounds their residuals.
  if (rms_after > rms && !(options.tolerance && keeps_tolerance(after))) {
    report.optimize.why += "; what it found is farther from the points and was not taken";
    return;
  }
  if (leaves_box(result)) {
    report.optimize.why += "; what it found leaves the box of the points and was not taken";
    return;
  }
  if (folds(result)) {
    report.optimize.why += "; what it found folds and was not taken";
    return;
  }
  take();
}

SurfaceFit MeasureFit(const NurbsSurface& surface,
                      const PointCloud& cloud,
                      const MergedCloud& merged,
                      const PointMask& used,
                      const SurfaceFitOptions& options,
                      const std::string& shape,
                      ThreadPool& pool,
                      FitReport report,
                      const Eigen::Matrix2Xd* start,
                      const Eigen::Matrix2Xd* near) {
  const Eigen::Vector3d move = cloud.origin() - options.shift;
  NurbsSurface written = move.isZero(0) ? surface : surface.Translated(move);
  const NurbsSurface measured = move.isZero(0) ? surface : written.Translated(-move);
  const Eigen::Matrix3Xd& points = merged.cloud.points();
  const auto measure = [&]() -> PointDistances {
    if (start) return DistancesFrom(measured, points, *start, pool);
    if (!near) return DistancesTo(measured, points, pool);
    if (near->cols() == points.cols()) return DistancesTo(measured, points, *near, pool);
    return DistancesTo(measured, points, PlacesOf(used, *near), pool);
  };
  const PointDistances found = measure();
  SurfaceFit fit{std::move(written),
                 Eigen::Matrix2Xd(2, cloud.size()),
                 Eigen::VectorXd(cloud.size()),
                 PointMask(cloud.size()),
                 {}};
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    const Eigen::Index place = merged.place[k];
    fit.parameters.col(k) = found.parameters.col(place);
    fit.residuals[k] = found.distances[place];
    fit.outliers[k] = !used[place];
  }
  report.error_all = Summarise(fit.residuals, options.tolerance);
  report.error = fit.outliers.any() ? Summarise(fit.residuals, options.tolerance, !fit.outliers)
                                    : report.error_all;
  report.input.used = report.error.points;
  report.input.outliers = fit.outliers.count();
  EnterOvershoot(measured, merged, used, found.parameters, pool, report);
  report.overshoot->asked_for = options.trim == Trimming::kNone;
  report.geometry.kind = "surface";
  report.geometry.degree = {fit.surface.basis_u().degree(), fit.surface.basis_v().degree()};
  report.geometry.control_points = {fit.surface.size_u(), fit.surface.size_v()};
  report.geometry.rational = fit.surface.rational();
  report.geometry.trims = static_cast<int>(fit.surface.trims().size());
  report.geometry.closed = {fit.surface.basis_u().periodic(), fit.surface.basis_v().periodic()};
  if (report.geometry.primitive) {  // exact shapes close without periodic knots
    report.geometry.closed = {Closed(fit.surface, Direction::kU),
                              Closed(fit.surface, Direction::kV)};
    const CollapsedEdgeSet collapsed = CollapsedEdges(fit.surface);
    report.geometry.poles = {collapsed.v_lower, collapsed.v_upper};
  }
  if (found.uncertified > 0) report.warnings.push_back(UncertifiedText(found.uncertified));
  if (options.tolerance && report.error_all.out_of_tolerance > report.error.out_of_tolerance) {
    report.warnings.push_back(
        std::to_string(report.error_all.out_of_tolerance - report.error.out_of_tolerance) +
        " points out of tolerance were set aside as outliers and are not counted (error_all "
        "counts them)");
  }
  const bool fair = report.geometry.base != "grid";  // grids are filled first
  if (fair && fit.surface.size_u() * fit.surface.size_v() > report.input.used) {
    report.warnings.push_back(
        "there are more control points than points: fairness decides the rest");
  }
  if (!fit.surface.trimmed() && report.overshoot->share_without_points > kEmptyToWarn) {
    report.warnings.push_back("there are no points in " +
                              Percent(report.overshoot->share_without_points) +
                              " of the surface: it is a guess there");
  }
  WarnOfNoise(options, report);
  Judge(fit, cloud, options, shape, pool, report);
  fit.report = std::move(report);
  return fit;
}

}  // namespace batten::internal
