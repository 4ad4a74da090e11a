// SPDX-License-Identifier: MIT
#include "fitting/surface/inlier_classification.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "batten/fitting/distances.h"
#include "batten/fitting/refused_data.h"
#include "batten/fitting/robust_loss.h"
#include "batten/fitting/solve_linear.h"
#include "fitting/cloud/local_outlier_factor.h"
#include "fitting/cloud/residual_outliers.h"
#include "fitting/core/rules.h"
#include "fitting/core/shared_constants.h"
#include "fitting/least_squares/residual_structure.h"
#include "fitting/least_squares/reweighting.h"
#include "geometry/numeric/number_text.h"

namespace batten::internal {
namespace {

constexpr double kLeastScale = 1e-3;  // spacings: least outlier threshold of exact points
constexpr int kOutlierPasses = 5;
constexpr double kFewChanges = 0.01;
constexpr double kConverged = 1e-3;           // share of points and of squares: the grid is kept
constexpr int kLargeGrid = 1500;              // searching its size anew takes long …
constexpr Eigen::Index kManyPoints = 200000;  // … as it does with many points
constexpr double kMisses = 3;                 // scale over noise; above: the shape is missed
constexpr double kBeyondStructure = 2;        // spacings
constexpr double kOnSurface = 0.8;            // share of a part's points
constexpr double kLayersToRefuse = 0.4;       // share of places with two layers; above: refused

// Whether outliers that their neighbours tell are so many that a loss must bound them.
bool StartsRobust(const FitContext& context) {
  const SurfaceFitOptions& options = context.options();
  if (options.loss) return *options.loss != Loss::kNone;
  return !options.keep_outliers &&
         static_cast<double>(context.prepared().statistics.outlier_count) >
             kOutlierShareForLoss * static_cast<double>(context.points().size());
}

// Removes isolated points: outliers on the surface's continuation beyond an edge of the shape have
// small residuals and are found by isolation only.
PointMask WithoutIsolated(const FitContext& context, bool robust, PointMask mask) {
  if (!robust || context.base().exact || context.options().keep_outliers ||
      !Acts(Rule::kIsolatedPoints))
    return mask;
  const auto outliers = static_cast<double>(context.prepared().statistics.outlier_count),
             all = static_cast<double>(context.points().size());
  return NonIsolatedPoints(
      context.points().points(), mask, context.pool(), outliers > kManyStrays * all);
}

// The passes, over what they hand on.
class InlierPasses {
 public:
  InlierPasses(FitContext& context, bool robust, const PointMask& used)
      : context_(context),
        options_(context.options()),
        found_{used, {}, context.ProblemOf(used), robust} {}

  ClassifiedPoints Run() && {
    bool settled = false;      // few points changed class: the grid is nearly right
    bool few_changed = false;  // too few and too near the surface to change it
    for (int pass = 1; pass <= kOutlierPasses; ++pass) {
      found_.cloud = found_.used.all() ? context_.points() : context_.points().Subset(found_.used);
      const FittingProblem last = found_.problem;
      if (pass > 1) Take(context_.ProblemOf(found_.used));
      if (few_changed) {
        Take(found_.problem.WithBases(last.basis_u(), last.basis_v()));
      } else {
        ChooseBases(settled && IsLarge(last) ? &last : nullptr);
      }
      if (pass == 1) RefuseTwoSheets();
      if (found_.robust) Reweight();
      PointMask& used = found_.used;
      if (pass == kOutlierPasses || (options_.keep_outliers && used.all())) break;
      if (options_.keep_outliers) {
        context_.PlaceTheRest(Surface());
        used.setConstant(true);
        continue;
      }
      const PointMask now = WithoutIsolated(context_, found_.robust, InliersOfSurface());
      if (now.count() < kFewestSurfacePoints) break;
      if (!found_.robust && !options_.loss && (now != used).any() && !now.all()) {
        found_.robust = true;  // outliers have bent the plain fit
        continue;
      }
      const Eigen::Index changed = (now != used).count();
      if (changed == 0) break;
      settled = static_cast<double>(changed) < kFewChanges * static_cast<double>(now.size());
      few_changed = !found_.robust && Converged(now != used);
      used = now;
    }
    // With a tolerance the user defines which residuals matter: robust weights serve only to choose
    // the bases.
    if (options_.tolerance && found_.robust && !options_.loss)
      Take(context_.ProblemOf(found_.used)
               .WithBases(found_.problem.basis_u(), found_.problem.basis_v()));
    return std::move(found_);
  }

 private:
  // Sets the present problem.
  void Take(FittingProblem problem) {
    found_.problem = std::move(problem);
    solution_.reset();
  }

  // The solution of the present problem, computed once.
  const LinearSolution& Solution() {
    if (!solution_) solution_ = SolveLinear(found_.problem, context_.pool());
    return *solution_;
  }
  NurbsSurface Surface() {
    return context_.base().Surface(
        found_.problem.basis_u(), found_.problem.basis_v(), Solution().coefficients);
  }
  SurfaceResiduals Residuals() {
    return {found_.problem.data().parameters,
            context_.base().Residuals(found_.problem, Solution().coefficients, context_.pool()),
            options_.seed};
  }

  // Whether searching the size of the grid anew takes long.
  bool IsLarge(const FittingProblem& problem) const {
    return problem.unknowns() > kLargeGrid || found_.cloud.size() > kManyPoints;
  }

  // The bases, given or chosen; the search starts near those of a similar problem if any.
  void ChooseBases(const FittingProblem* similar) {
    if (options_.control_points) {
      return Take(context_.WithCells(found_.problem,
                                     options_.control_points->first - options_.degree_u,
                                     options_.control_points->second - options_.degree_v));
    }
    GridLimits limits;
    limits.degree_u = options_.degree_u;
    limits.degree_v = options_.degree_v;
    limits.max_control_points = options_.max_control_points;
    if (!context_.base().exact && context_.noise() > 0) limits.noise = context_.noise();
    limits.near_cells_u = context_.base().settled_cells_u;
    limits.near_cells_v = context_.base().settled_cells_v;
    if (similar != nullptr) {
      limits.near_cells_u = similar->basis_u().size() - options_.degree_u;
      limits.near_cells_v = similar->basis_v().size() - options_.degree_v;
    }
    const GridChoice choice =
        ChooseGrid(found_.problem, limits, context_.pool(), options_.progress);
    found_.rounds.insert(found_.rounds.end(), choice.rounds.begin(), choice.rounds.end());
    found_.tried.insert(found_.tried.end(), choice.tried.begin(), choice.tried.end());
    found_.noise_is_shared = choice.blocks_disagree;
    Take(context_.WithCells(found_.problem, choice.cells_u, choice.cells_v));
  }

  void Reweight() {
    if (!options_.loss && !Acts(Rule::kReweighting)) return;
    ReweightingOptions reweighting{.loss = options_.loss.value_or(Loss::kTukey),
                                   .loss_scale = options_.loss_scale,
                                   .progress = options_.progress};
    // Exact points that are off by so little are good: it is the surface that misses them.
    if (!options_.loss) reweighting.least_scale = kLeastScale * context_.spacing() / kTukeyTuning;
    Take(Reweighted(
        found_.problem,
        reweighting,
        [&](const FittingProblem& problem, const LinearSolution& solution) {
          return context_.base().Residuals(problem, solution.coefficients, context_.pool());
        },
        context_.pool(),
        found_.rounds));
  }

  void RefuseTwoSheets() {
    if (context_.base().exact) return;
    const double share = DoubleLayerFractionOf(Residuals(), context_.pool());
    if (share <= kLayersToRefuse) return;
    throw TwoSheets("in " + Percent(share) +
                        " of places the points lie on two sheets, one above the other: one "
                        "surface would run between them; fit one of them",
                    Remedy::kFitPart);
  }

  // The outlier threshold for distances from a surface with this scale.
  double FarthestGood(double scale) const {
    return LeastOutlierDistance(scale, context_.noise(), context_.spacing(), options_);
  }

  // Whether points are few, with a small share of the sum of squares of the last distances.
  bool Converged(const PointMask& points) const {
    const Eigen::ArrayXd squares = distances_.array().square();
    return static_cast<double>(points.count()) < kConverged * static_cast<double>(points.size()) &&
           points.select(squares, 0).sum() < kConverged * found_.used.select(squares, 0).sum();
  }

  // The mask of inliers of the present solution among all points.
  PointMask InliersOfSurface() {
    const NurbsSurface surface = Surface();
    context_.PlaceTheRest(surface);
    const Eigen::Matrix2Xd& parameters = context_.base().parameters;
    distances_ =
        DistancesFrom(surface, context_.points().points(), parameters, context_.pool()).distances;
    Eigen::VectorXd of_used(found_.cloud.size());
    Eigen::Index count = 0;
    for (Eigen::Index k = 0; k < distances_.size(); ++k)
      if (found_.used[k]) of_used[count++] = distances_[k];
    const double limit = FarthestGood(options_.loss_scale.value_or(RobustScale(of_used)));
    PointMask close =
        Acts(Rule::kNeighbourVotes)
            ? ResidualInliers(parameters, distances_, limit, context_.spacing(), context_.pool())
            : (distances_.array().abs() <= limit).eval();
    // Points without parameters in the base must be on the surface: places next to each other do
    // not make them neighbours.
    for (Eigen::Index k = 0; k < close.size(); ++k)
      if (!context_.prepared().reached[k])
        close[k] =
            std::abs(distances_[k]) <= limit && (context_.base().exact || context_.IsInside(k));
    LeaveOutPartsOff(close);
    return close;
  }

  // A part beside the others is on the surface as a whole or not at all: a surface passes through
  // some of any object's points.
  void LeaveOutPartsOff(PointMask& close) const {
    const std::vector<int>& parts = context_.prepared().set_aside;
    if (parts.empty()) return;
    const auto count = static_cast<size_t>(*std::ranges::max_element(parts) + 1);
    std::vector<Eigen::Index> all(count), on(count);
    for (size_t k = 0; k < parts.size(); ++k) {
      if (parts[k] < 0) continue;
      ++all[static_cast<size_t>(parts[k])];
      on[static_cast<size_t>(parts[k])] += close[static_cast<Eigen::Index>(k)];
    }
    for (size_t k = 0; k < parts.size(); ++k) {
      if (parts[k] < 0) continue;
      const auto own = static_cast<size_t>(parts[k]);
      close[static_cast<Eigen::Index>(k)] &=
          static_cast<double>(on[own]) >= kOnSurface * static_cast<double>(all[own]);
    }
  }

  FitContext& context_;
  const SurfaceFitOptions& options_;
  ClassifiedPoints found_;
  std::optional<LinearSolution> solution_;  // of the problem, computed on demand
  Eigen::VectorXd distances_;               // of all points, at the last classification
};

}  // namespace

double LeastOutlierDistance(double scale,
                            double noise,
                            double spacing,
                            const SurfaceFitOptions& options) {
  const bool misses = scale > kMisses * noise;
  return std::max({kTukeyTuning * scale,
                   (misses ? kBeyondStructure : kLeastScale) * spacing,
                   options.tolerance.value_or(0)});
}

ClassifiedPoints ClassifyInliers(FitContext& context) {
  const bool robust = StartsRobust(context);
  return InlierPasses(context, robust, WithoutIsolated(context, robust, context.prepared().used))
      .Run();
}

}  // namespace batten::internal
