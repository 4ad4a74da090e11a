// SPDX-License-Identifier: MIT
#include "fitting/parameterization/base_score.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/robust_loss.h"
#include "batten/fitting/solve_linear.h"
#include "fitting/core/shared_constants.h"
#include "fitting/knots/block_validation.h"
#include "fitting/knots/knot_grid_selection.h"
#include "fitting/least_squares/fitting_bases.h"

namespace batten::internal {
namespace {

constexpr Eigen::Index kSample = 30000;
constexpr double kShapeInSpacings = 0.25;

int Rounded(double cells, int least) {
  return std::max(least, static_cast<int>(std::lround(cells)));
}

}  // namespace

BaseScore::BaseScore(const PointCloud& points,
                     const std::vector<Eigen::Index>& kept,
                     const SurfaceFitOptions& options,
                     ThreadPool& pool)
    : points_(points),
      options_(options),
      pool_(pool),
      sample_(PointMask::Constant(points.size(), false)) {
  const auto count = static_cast<Eigen::Index>(kept.size());
  for (const Eigen::Index k : SampleIndices(count, kSample, options.seed)) {
    sample_[kept[static_cast<size_t>(k)]] = true;
  }
}

FittingProblem BaseScore::ProblemOf(const Parameterization& base, const PointMask& reached) const {
  return base.ProblemOf(points_,
                        sample_ && reached,
                        std::min(options_.degree_u, kProbeDegree),
                        std::min(options_.degree_v, kProbeDegree),
                        kSurfaceSmoothing);
}

BaseScore::Value BaseScore::Of(const Parameterization& base, const PointMask& reached) const {
  return Near(base, reached, {0, base.settled_cells_u, base.settled_cells_v, 0});
}

BaseScore::Value BaseScore::Near(const Parameterization& base,
                                 const PointMask& reached,
                                 const Value& near) const {
  if (!(reached && sample_).any()) return {HUGE_VAL, near.cells_u, near.cells_v, 0};
  const FittingProblem problem = ProblemOf(base, reached);
  GridLimits limits;
  limits.degree_u = problem.basis_u().degree();
  limits.degree_v = problem.basis_v().degree();
  limits.near_cells_u = near.cells_u;
  limits.near_cells_v = near.cells_v;
  limits.blocks = false;
  const GridChoice grid = ChooseGrid(problem, limits, pool_, options_.progress);
  return At(base, problem, grid.cells_u, grid.cells_v);
}

BaseScore::Value BaseScore::AtMost(const Parameterization& base,
                                   const PointMask& reached,
                                   const Value& near,
                                   double most_control_points) const {
  constexpr int kMostSteps = 4;
  const FittingProblem problem = ProblemOf(base, reached);
  const int least_u = LeastCells(problem.basis_u(), problem.basis_u().degree()),
            least_v = LeastCells(problem.basis_v(), problem.basis_v().degree());
  const auto count = static_cast<double>(problem.size());
  const auto score = [&](double cells_u, double cells_v) {
    const FittingProblem own =
        OverCells(problem, Rounded(cells_u, least_u), Rounded(cells_v, least_v));
    if (own.unknowns() > std::min(most_control_points, count / kLeastPointsPerControlPoint))
      return HUGE_VAL;
    const double freedom = count - kFreedomFactor * own.unknowns();
    return SolveLinear(own, pool_).residual_squares / (freedom * freedom);
  };
  const double start = std::sqrt(static_cast<double>(near.cells_u) * near.cells_v);
  double cells_u = start * std::sqrt(base.length_u / base.length_v),
         cells_v = start * start / cells_u;
  double best = score(cells_u, cells_v);
  // More or fewer cells in both directions, then more in one at the cost of the other, then both.
  for (const auto& [step_u, step_v] : {std::pair{1.25, 1.25}, {1.2, 1 / 1.2}, {1.1, 1.1}}) {
    for (const int sign : {1, -1}) {
      bool better = false;
      for (int k = 0; k < kMostSteps; ++k) {
        const double next_u = cells_u * std::pow(step_u, sign),
                     next_v = cells_v * std::pow(step_v, sign);
        const double next = score(next_u, next_v);
        if (!(next < best)) break;
        best = next;
        cells_u = next_u;
        cells_v = next_v;
        better = true;
      }
      if (better) break;
    }
  }
  return At(base, problem, Rounded(cells_u, least_u), Rounded(cells_v, least_v));
}

BaseScore::Value BaseScore::At(const Parameterization& base,
                               const FittingProblem& problem,
                               int cells_u,
                               int cells_v) const {
  const FittingProblem chosen = OverCells(problem, cells_u, cells_v);
  const Eigen::VectorXd residuals =
      base.Residuals(chosen, SolveLinear(chosen, pool_).coefficients, pool_);
  // Residuals are clipped, since a few outliers may be left; small ones against the spacing are
  // not.
  const double most =
      std::max(kTukeyTuning * RobustScale(residuals), kShapeInSpacings * ParameterSpacing(problem));
  const double squares = residuals.cwiseAbs().cwiseMin(most).squaredNorm();
  const auto count = static_cast<double>(problem.size());
  const double freedom = std::max(1.0, count - kFreedomFactor * chosen.unknowns());
  return {count * squares / (freedom * freedom), cells_u, cells_v, chosen.unknowns()};
}

}  // namespace batten::internal
