// SPDX-License-Identifier: MIT
#include "batten/fitting/base_score.h"

#include <algorithm>
#include <cmath>

#include "batten/fitting/block_validation.h"
#include "batten/fitting/fitting_bases.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/grid_selection.h"
#include "batten/fitting/robust_loss.h"

namespace batten {
namespace {

constexpr Eigen::Index kSample = 30000;
constexpr double kSmoothing = 1e-4;  // as in the fit itself
constexpr int kMostDegree = 3;
constexpr double kShapeInSpacings = 0.25;
constexpr double kOutlierInScales = 4.685;

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

BaseScore::Value BaseScore::Of(const SurfaceBase& base, const PointMask& reached) const {
  // Higher degrees cost much and tell no more.
  const int degree_u = std::min(options_.degree_u, kMostDegree),
            degree_v = std::min(options_.degree_v, kMostDegree);
  const FittingProblem problem =
      base.ProblemOf(points_, sample_ && reached, degree_u, degree_v, kSmoothing);
  GridLimits limits;
  limits.degree_u = degree_u;
  limits.degree_v = degree_v;
  limits.blocks = false;
  const GridChoice grid = ChooseGrid(problem, limits, pool_, options_.progress);
  const FittingProblem chosen =
      problem.WithBases(FittingBasisLike(problem.basis_u(), degree_u, grid.cells_u),
                        FittingBasisLike(problem.basis_v(), degree_v, grid.cells_v));
  const Eigen::VectorXd residuals =
      base.Residuals(chosen, SolveLinear(chosen, pool_).coefficients, pool_);
  // A few outliers may be left: they must not tell. What is small against the spacing is none.
  const double most = std::max(kOutlierInScales * RobustScale(residuals),
                               kShapeInSpacings * ParameterSpacing(problem));
  const double squares = residuals.cwiseAbs().cwiseMin(most).squaredNorm();
  const auto count = static_cast<double>(problem.size());
  const double freedom = std::max(1.0, count - kFreedomFactor * chosen.unknowns());
  return {count * squares / (freedom * freedom), grid.cells_u, grid.cells_v, chosen.unknowns()};
}

}  // namespace batten
