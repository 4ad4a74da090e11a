// SPDX-License-Identifier: MIT
#include "fitting/surface/surface_fitter.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/distances.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/solve_linear.h"
#include "fitting/cloud/local_outlier_factor.h"
#include "fitting/cloud/residual_outliers.h"
#include "fitting/constraints/constrained_surface.h"
#include "fitting/knots/knot_grid_selection.h"
#include "fitting/knots/knot_line_removal.h"
#include "fitting/least_squares/choose_smoothing.h"
#include "fitting/least_squares/fitting_bases.h"
#include "fitting/least_squares/residual_noise.h"
#include "fitting/least_squares/residual_structure.h"
#include "fitting/least_squares/reweighting.h"
#include "fitting/surface/gap_regularization.h"
#include "fitting/surface/refine.h"

namespace batten::internal {
namespace {

constexpr double kSmoothing = 1e-4;
constexpr double kLeastScale = 1e-3;        // spacings: least outlier threshold of exact points
constexpr double kOutlierInScales = 4.685;  // scales: Tukey's loss gives zero weight beyond
constexpr int kMostForGaps = 16;  // times the control points, to turn a surface inside a gap
constexpr int kOutlierPasses = 5;
constexpr double kFewChanges = 0.01;
constexpr double kConverged = 1e-3;           // share of points and of squares: the grid is kept
constexpr int kLargeGrid = 1500;              // searching its size anew takes long …
constexpr Eigen::Index kManyPoints = 200000;  // … as it does with many points
constexpr Eigen::Index kFewestPoints = 4;
constexpr double kMisses = 3;            // scale over noise; above: the shape is missed
constexpr double kBeyondStructure = 2;   // spacings
constexpr double kSpoilt = 5;            // times the plain misfit; above: loss rejected
constexpr double kLayersToRefuse = 0.4;  // share of places with two layers; above: refused

// One fit in stages; members carry the state between stages.
class SurfaceFitter {
 public:
  SurfaceFitter(const PreparedCloud& prepared,
                const SurfaceFitOptions& options,
                FitReport report,
                ThreadPool& pool,
                StageClock& clock)
      : prepared_(prepared),
        own_base_(prepared.reached.all() ? Parameterization{} : prepared.base),
        base_(prepared.reached.all() ? prepared.base : own_base_),
        points_(prepared.merged.cloud),
        options_(options),
        pool_(pool),
        clock_(clock),
        report_(std::move(report)),
        used_(prepared.used) {}

  FittedState Run() {
    RequireRoomToClose();
    clock_.Enter(&StageSeconds::solve);
    ClassifyInliers();
    if (options_.tolerance) {
      Refine();
    } else {
      Solve();
    }
    if (prepared_.conditions.any()) MeetConditions();
    if (noise_is_shared_) {
      report_.warnings.push_back(
          "neighbouring points share their noise: blocks of left-out points are predicted better "
          "with fewer control points than single ones ask for, and those were taken");
    }
    Eigen::VectorXd weights = problem_->data().weights;
    SurfaceState draft{std::move(*surface_),
                       std::move(used_cloud_),
                       std::move(parameters_),
                       std::move(weights),
                       base_.poles,
                       robust_,
                       noise_is_shared_};
    ReleaseData();
    if (prepared_.conditions.any()) {
      report_.optimize.why = "the surface meets conditions, which free points would leave";
    } else {
      OptimiseWhereItPays(draft, options_, pool_, clock_, report_);
    }
    report_.geometry.distortion = DistortionAt(draft.surface, draft.parameters);
    report_.geometry.poles = {base_.poles.start != PoleKind::kNone,
                              base_.poles.end != PoleKind::kNone};
    const bool doubted = !options_.loss && !options_.keep_outliers && (robust_ || !used_.all());
    return {std::move(draft), std::move(used_), empty_area_fraction_, doubted, std::move(report_)};
  }

 private:
  // Frees memory that only the stages before the draft need.
  void ReleaseData() {
    problem_.reset();
    solution_.reset();
    distances_.resize(0);
  }

  FittingProblem ProblemOf(const PointMask& mask) const {
    return base_.ProblemOf(points_,
                           mask,
                           options_.degree_u,
                           options_.degree_v,
                           options_.smoothing.value_or(kSmoothing));
  }

  // Uniform knots over given parameters.
  SplineBasis Cells(const SplineBasis& like, int degree, int cells) const {
    return base_.exact ? SplineBasis::Uniform(degree, degree + cells, like.lower(), like.upper())
                       : FittingBasisLike(like, degree, cells);
  }

  FittingProblem WithCells(const FittingProblem& problem, int cells_u, int cells_v) const {
    return problem.WithBases(Cells(problem.basis_u(), options_.degree_u, cells_u),
                             Cells(problem.basis_v(), options_.degree_v, cells_v));
  }

  // In a periodic direction the last control points repeat the first.
  void RequireRoomToClose() const {
    const auto least = [](bool periodic, int degree) {
      return periodic ? 2 * degree + 1 : degree + 1;
    };
    const int least_u = least(base_.periodic_u, options_.degree_u),
              least_v = least(base_.periodic_v, options_.degree_v);
    const auto reject = [](const std::string& what, int degree, int count) {
      throw std::invalid_argument(what + " are too few: in a closed direction the last " +
                                  std::to_string(degree) + " repeat the first, so at least " +
                                  std::to_string(count) + " are needed");
    };
    if (!options_.control_points) {
      if (options_.max_control_points >= least_u * least_v) return;
      reject("max_control_points: " + std::to_string(options_.max_control_points),
             base_.periodic_u ? options_.degree_u : options_.degree_v,
             least_u * least_v);
    }
    const auto require = [&](int count, int degree, int needed) {
      if (count >= needed) return;
      reject("control_points: " + std::to_string(count) + " of degree " + std::to_string(degree),
             degree,
             needed);
    };
    require(options_.control_points->first, options_.degree_u, least_u);
    require(options_.control_points->second, options_.degree_v, least_v);
  }

  // The bases for a problem, given or chosen; the search starts near those of a similar problem if
  // any.
  FittingProblem WithChosenBases(const FittingProblem& problem, const FittingProblem* similar) {
    if (options_.control_points) {
      return WithCells(problem,
                       options_.control_points->first - options_.degree_u,
                       options_.control_points->second - options_.degree_v);
    }
    GridLimits limits;
    limits.degree_u = options_.degree_u;
    limits.degree_v = options_.degree_v;
    limits.max_control_points = options_.max_control_points;
    if (!base_.exact && prepared_.statistics.noise > 0) limits.noise = prepared_.statistics.noise;
    if (similar != nullptr) {
      limits.near_cells_u = similar->basis_u().size() - options_.degree_u;
      limits.near_cells_v = similar->basis_v().size() - options_.degree_v;
    }
    const GridChoice choice = ChooseGrid(problem, limits, pool_, options_.progress);
    Record(choice.rounds);
    noise_is_shared_ = choice.blocks_disagree;
    return WithCells(problem, choice.cells_u, choice.cells_v);
  }

  // Classifies inliers by their neighbours before there is a surface, then by their distance from
  // it, until the classification is stable. The bases are chosen anew each time.
  void ClassifyInliers() {
    robust_ = options_.loss ? *options_.loss != Loss::kNone
                            : !options_.keep_outliers &&
                                  static_cast<double>(prepared_.statistics.outlier_count) >
                                      kOutlierShareForLoss * static_cast<double>(points_.size());
    used_ = WithoutFlagged(used_);
    bool settled = false;      // few points changed class: the grid is nearly right
    bool few_changed = false;  // too few and too near the surface to change it
    for (int pass = 1; pass <= kOutlierPasses; ++pass) {
      used_cloud_ = used_.all() ? points_ : points_.Subset(used_);
      const bool search_near =
          settled && (problem_->unknowns() > kLargeGrid || used_cloud_.size() > kManyPoints);
      FittingProblem problem = ProblemOf(used_);
      Take(few_changed ? problem.WithBases(problem_->basis_u(), problem_->basis_v())
                       : WithChosenBases(problem, search_near ? &*problem_ : nullptr));
      if (pass == 1) RefuseTwoSheets();
      if (robust_) ReweightWhereItHelps();
      if (pass == kOutlierPasses || (options_.keep_outliers && used_.all())) break;
      if (options_.keep_outliers) {
        PlaceTheRest(Surface());
        used_.setConstant(true);
        continue;
      }
      const PointMask now = WithoutFlagged(InliersOfSurface());
      if (now.count() < kFewestPoints) break;
      if (!robust_ && !loss_rejected_ && !options_.loss && (now != used_).any() && !now.all()) {
        robust_ = true;  // outliers have bent the plain fit
        continue;
      }
      const Eigen::Index changed = (now != used_).count();
      if (changed == 0) break;
      settled = static_cast<double>(changed) < kFewChanges * static_cast<double>(now.size());
      few_changed = !robust_ && Converged(now != used_);
      used_ = now;
    }
    if (options_.tolerance && robust_ && !options_.loss) {
      // With a tolerance the user defines which residuals matter: robust weights serve only to
      // choose the bases.
      Take(ProblemOf(used_).WithBases(problem_->basis_u(), problem_->basis_v()));
    }
  }

  // Removes isolated points: outliers on the surface's continuation beyond an edge of the shape
  // have small residuals and are found by isolation only.
  PointMask WithoutFlagged(PointMask mask) const {
    if (!robust_ || base_.exact || options_.keep_outliers) return mask;
    return NonIsolatedPoints(points_.points(), mask, pool_);
  }

  // Reweights with a loss the user did not ask for, unless that increases the misfit much: where a
  // surface is nearly exact the scale is so small that a tip or a crease it follows less well is
  // taken for outliers, loses weight, and then deviates even more.
  void ReweightWhereItHelps() {
    if (options_.loss) return Reweight();
    const FittingProblem plain = *problem_;
    const SurfaceResiduals before = Residuals();
    const PointMask spoken = ResidualInliers(before.parameters,
                                             before.residuals,
                                             FarthestGood(RobustScale(before.residuals)),
                                             prepared_.statistics.spacing,
                                             pool_);
    Reweight();
    const Eigen::VectorXd after = Residuals().residuals;
    const double misfit_before = spoken.select(before.residuals.array(), 0).matrix().norm();
    const double misfit_after = spoken.select(after.array(), 0).matrix().norm();
    if (misfit_after <= kSpoilt * misfit_before) return;
    Take(plain);
    robust_ = false;
    loss_rejected_ = true;
  }

  void Reweight() {
    Take(Reweighted(
        *problem_,
        {options_.loss.value_or(Loss::kTukey), options_.loss_scale, options_.progress},
        [&](const FittingProblem& problem, const LinearSolution& solution) {
          return base_.Residuals(problem, solution.coefficients, pool_);
        },
        pool_,
        report_.iterations));
  }

  // Sets the present problem.
  void Take(FittingProblem problem) {
    problem_ = std::move(problem);
    solution_.reset();
  }

  // The solution of the present problem, computed once.
  const LinearSolution& Solution() {
    if (!solution_) solution_ = SolveLinear(*problem_, pool_);
    return *solution_;
  }
  NurbsSurface Surface() {
    return base_.Surface(problem_->basis_u(), problem_->basis_v(), Solution().coefficients);
  }
  SurfaceResiduals Residuals() {
    return {problem_->data().parameters,
            base_.Residuals(*problem_, Solution().coefficients, pool_),
            options_.seed};
  }

  void RefuseTwoSheets() {
    if (base_.exact) return;
    const double share = DoubleLayerFractionOf(Residuals(), pool_);
    if (share <= kLayersToRefuse) return;
    throw std::invalid_argument(
        "in " + std::to_string(std::lround(100 * share)) +
        " % of places the points lie on two sheets, one above the other: one "
        "surface would run between them; fit one of them (--box, --where)");
  }

  // Gives points without parameters in the base those of their foot points on the surface.
  void PlaceTheRest(const NurbsSurface& surface) {
    if (prepared_.reached.all()) return;
    std::vector<Eigen::Index> rest;
    for (Eigen::Index k = 0; k < prepared_.reached.size(); ++k)
      if (!prepared_.reached[k]) rest.push_back(k);
    const Eigen::Matrix3Xd points = points_.points()(Eigen::all, rest);
    own_base_.parameters(Eigen::all, rest) = DistancesTo(surface, points, pool_).parameters;
  }

  // Whether a point's place is not on the domain's border.
  bool IsInside(Eigen::Index k) const {
    const auto place = base_.parameters.col(k);
    return (base_.periodic_u || (place[0] > 0 && place[0] < base_.length_u)) &&
           (base_.periodic_v ||
            ((place[1] > 0 || base_.poles.start != PoleKind::kNone) &&
             (place[1] < base_.length_v || base_.poles.end != PoleKind::kNone)));
  }

  // The outlier threshold for distances from a surface with this scale.
  double FarthestGood(double scale) const {
    // A surface that misses the shape can identify only outliers far beyond the structure between
    // points.
    const bool misses = loss_rejected_ || scale > kMisses * prepared_.statistics.noise;
    return std::max({kOutlierInScales * scale,
                     (misses ? kBeyondStructure : kLeastScale) * prepared_.statistics.spacing,
                     options_.tolerance.value_or(0)});
  }

  // Whether points are few, with a small share of the sum of squares of the last distances.
  bool Converged(const PointMask& points) const {
    const Eigen::ArrayXd squares = distances_.array().square();
    return static_cast<double>(points.count()) < kConverged * static_cast<double>(points.size()) &&
           points.select(squares, 0).sum() < kConverged * used_.select(squares, 0).sum();
  }

  // The mask of inliers of the present solution among all points.
  PointMask InliersOfSurface() {
    const NurbsSurface surface = Surface();
    PlaceTheRest(surface);
    distances_ = DistancesFrom(surface, points_.points(), base_.parameters, pool_).distances;
    const Eigen::VectorXd& distances = distances_;
    Eigen::VectorXd of_used(used_cloud_.size());
    Eigen::Index count = 0;
    for (Eigen::Index k = 0; k < distances.size(); ++k) {
      if (used_[k]) of_used[count++] = distances[k];
    }
    const double scale = options_.loss_scale.value_or(RobustScale(of_used));
    const double limit = FarthestGood(scale);
    PointMask close =
        ResidualInliers(base_.parameters, distances, limit, prepared_.statistics.spacing, pool_);
    // Points without parameters in the base must be on the surface: no neighbours can classify
    // them.
    for (Eigen::Index k = 0; k < close.size(); ++k) {
      if (!prepared_.reached[k]) close[k] = std::abs(distances[k]) <= limit && IsInside(k);
    }
    return close;
  }

  // The coarsest grid that cross-validation has tried, up to the one it chose, that keeps the
  // tolerance; else the chosen one.
  FittingProblem CoarsestWithin() const {
    for (const RoundSummary& round : report_.iterations) {
      if (!round.stage.starts_with("cross-validation") || round.rms > *options_.tolerance) continue;
      if (round.control_points_u * round.control_points_v >= problem_->unknowns()) continue;
      const FittingProblem coarse = WithCells(*problem_,
                                              round.control_points_u - options_.degree_u,
                                              round.control_points_v - options_.degree_v);
      const NurbsSurface surface = base_.Surface(
          coarse.basis_u(), coarse.basis_v(), SolveLinear(coarse, pool_).coefficients);
      const PointDistances found =
          DistancesFrom(surface, used_cloud_.points(), coarse.data().parameters, pool_);
      if (found.distances.cwiseAbs().maxCoeff() <= *options_.tolerance) return coarse;
    }
    return *problem_;
  }

  void Refine() {
    clock_.Enter(&StageSeconds::refine);
    if (!options_.control_points) Take(CoarsestWithin());
    RefineOptions refine;
    refine.tolerance = *options_.tolerance;
    refine.noise = prepared_.statistics.noise;
    refine.spacing = prepared_.statistics.spacing;
    refine.max_control_points =
        options_.control_points ? problem_->unknowns() : options_.max_control_points;
    RefineResult refined = RefineToTolerance(*problem_,
                                             base_.plane ? &*base_.plane : nullptr,
                                             used_cloud_.points(),
                                             refine,
                                             pool_,
                                             options_.progress);
    Record(refined.rounds);
    report_.end.code = refined.end;
    surface_ = std::move(refined.surface);
    // Where parameters are part of the data the joint stage starts from those.
    parameters_ = base_.exact ? problem_->data().parameters : std::move(refined.parameters);
    empty_area_fraction_ = refined.empty_area_fraction;
  }

  // The fairness weight chosen from the data.
  double Smoothing() {
    if (options_.smooth_by == SmoothBy::kCrossValidation)
      return SmoothingByCrossValidation(*problem_, pool_, options_.progress);
    // The noise of the values: on slopes the noise along the normal is less than that of heights,
    // and over a sheet the parameters absorb the tangential part.
    const Eigen::MatrixXd off =
        problem_->data().values - EvaluateAt(*problem_, Solution().coefficients, pool_);
    const auto count = static_cast<double>(problem_->size());
    const double left = count - EffectiveFreedom(*problem_, pool_);
    const double variance =
        ResidualNoise(problem_->data().parameters).Variance(off, problem_->data().weights) * count /
        std::max(1.0, left);
    const double noise = std::sqrt(variance / static_cast<double>(off.rows()));
    if (!(noise > 0)) return problem_->smoothing();
    return SmoothingFromNoise(*problem_, noise, pool_, options_.progress);
  }

  void Solve() {
    if (!options_.control_points) {
      // Finer grids would follow noise correlated between neighbours.
      Take(noise_is_shared_
               ? PruneKnotLines(*problem_, pool_)
               : RefineAndPruneKnotLines(*problem_, options_.max_control_points, pool_));
    }
    if (options_.smooth_by != SmoothBy::kWeight) Take(problem_->WithSmoothing(Smoothing()));
    GapRegularizationOptions gap_options;
    gap_options.spacing = prepared_.statistics.spacing;
    gap_options.measured = used_cloud_.size();
    gap_options.most_control_points =
        options_.control_points
            ? problem_->unknowns()
            : std::min(options_.max_control_points, kMostForGaps * problem_->unknowns());
    GapRegularizationResult regularized = SolveWithGapRegularization(*problem_, gap_options, pool_);
    Take(regularized.problem);
    const LinearSolution& solution = regularized.solution;
    empty_area_fraction_ = regularized.empty_area_fraction;
    if (solution.regularised) {
      report_.warnings.push_back(
          "the points do not determine every control point: fairness was raised");
    }
    report_.end.code = EndCode::kCrossValidated;
    surface_ = base_.Surface(problem_->basis_u(), problem_->basis_v(), solution.coefficients);
    parameters_ = problem_->data().parameters;
  }

  // Solves under the constraints over the bases chosen without them.
  void MeetConditions() {
    clock_.Enter(&StageSeconds::solve);
    const FittingProblem problem =
        options_.tolerance ? ProblemOf(used_).WithBases(surface_->basis_u(), surface_->basis_v())
                           : *problem_;
    const SurfaceConstraints constraints = ConstraintsOf(prepared_.conditions);
    ConstrainedSolution solution = SolveConstrained(problem, constraints, pool_);
    for (const MissedConstraint& missed : solution.missed)
      report_.warnings.push_back(missed.Text());
    if (options_.control_points && solution.surface.control_points().cols() > problem.net_size()) {
      report_.warnings.push_back(
          "the curves given for edges have more knots than the control points asked for allow: "
          "theirs were taken too");
    }
    surface_ = std::move(solution.surface);
    parameters_ = problem.data().parameters;
  }

  void Record(const std::vector<RoundSummary>& rounds) {
    report_.iterations.insert(report_.iterations.end(), rounds.begin(), rounds.end());
  }

  const PreparedCloud& prepared_;
  Parameterization own_base_;  // with places for points that the given one does not reach
  const Parameterization& base_;
  const PointCloud& points_;
  const SurfaceFitOptions& options_;
  ThreadPool& pool_;
  StageClock& clock_;
  FitReport report_;
  PointMask used_;                          // inliers among the merged points
  PointCloud used_cloud_;                   // the points of used_
  bool robust_ = false;                     // losses bound residuals
  bool loss_rejected_ = false;              // a loss was tried and rejected
  bool noise_is_shared_ = false;            // noise correlated between neighbours
  std::optional<FittingProblem> problem_;   // of the used points, with chosen bases
  std::optional<LinearSolution> solution_;  // of problem_, computed on demand
  Eigen::VectorXd distances_;               // of all points, at the last inlier classification
  std::optional<NurbsSurface> surface_;     // in the cloud's local coordinates
  Eigen::Matrix2Xd parameters_;             // of the used points
  double empty_area_fraction_ = 0;          // share of the domain in data gaps
};

}  // namespace

FittedState FitOverBase(const PreparedCloud& prepared,
                        const SurfaceFitOptions& options,
                        FitReport report,
                        ThreadPool& pool,
                        StageClock& clock) {
  return SurfaceFitter(prepared, options, std::move(report), pool, clock).Run();
}

}  // namespace batten::internal
