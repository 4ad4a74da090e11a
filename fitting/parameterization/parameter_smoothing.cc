// SPDX-License-Identifier: MIT
#include "fitting/parameterization/parameter_smoothing.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "batten/fitting/distances.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/solve_linear.h"
#include "fitting/core/shared_constants.h"
#include "fitting/least_squares/fitting_bases.h"

namespace batten::internal {
namespace {

// Shares of the cells chosen by cross-validation, in u and v.
constexpr std::pair<double, double> kShares[] = {
    {0.35, 0.35}, {0.5, 0.5}, {0.7, 0.7}, {1, 0.5}, {0.5, 1}, {1, 1}};
constexpr double kSmoothedClearlyBetter = 0.9995;
constexpr double kSmoothedAsGood = 0.9999;  // if there are clearly fewer control points

SplineBasis Cells(const SplineBasis& like, double cells) {
  return FittingBasisLike(like, kProbeDegree, std::max(1, static_cast<int>(std::lround(cells))));
}

// Base whose parameters are the foot points of the points under a mask.
Parameterization AtFootPoints(const Parameterization& base,
                              const NurbsSurface& surface,
                              const PointCloud& points,
                              const PointMask& mask,
                              ThreadPool& pool) {
  Parameterization moved = base;
  const PointCloud some = points.Subset(mask);
  Eigen::Matrix2Xd start(2, some.size());
  Eigen::Index next = 0;
  for (Eigen::Index k = 0; k < mask.size(); ++k) {
    if (mask[k]) start.col(next++) = base.parameters.col(k);
  }
  const Eigen::MatrixXd feet = DistancesFrom(surface, some.points(), start, pool).parameters;
  next = 0;
  for (Eigen::Index k = 0; k < mask.size(); ++k) {
    if (mask[k]) moved.parameters.col(k) = feet.col(next++);
  }
  return moved;
}

}  // namespace

Settled SmoothParameters(Parameterization& base,
                         const PointCloud& points,
                         const PointMask& mask,
                         const BaseScore& score,
                         const BaseScore::Value& before,
                         ThreadPool& pool) {
  const PointMask some = score.sample() && mask;
  Parameterization current = base;
  Settled settled{false, before};
  std::optional<NurbsSurface> chosen;
  for (const auto& [share_u, share_v] : kShares) {
    const FittingProblem one_cell =
        current.ProblemOf(points, some, kProbeDegree, kProbeDegree, kSurfaceSmoothing);
    const FittingProblem problem =
        one_cell.WithBases(Cells(one_cell.basis_u(), share_u * before.cells_u),
                           Cells(one_cell.basis_v(), share_v * before.cells_v));
    NurbsSurface surface =
        base.Surface(problem.basis_u(), problem.basis_v(), SolveLinear(problem, pool).coefficients);
    Parameterization moved = AtFootPoints(current, surface, points, some, pool);
    const BaseScore::Value now = score.Near(moved, some, settled.value);
    const bool fewer = now.control_points < kClearlyFewer * settled.value.control_points;
    if (now.score >= (fewer ? kSmoothedAsGood : kSmoothedClearlyBetter) * settled.value.score)
      continue;
    settled.value = now;
    current = std::move(moved);
    chosen = std::move(surface);
  }
  settled.any = chosen.has_value();
  if (chosen) base = AtFootPoints(base, *chosen, points, mask, pool);
  return settled;
}

bool SmoothParameters(Parameterization& base,
                      const PointCloud& points,
                      const PointMask& mask,
                      const BaseScore& score,
                      ThreadPool& pool) {
  const BaseScore::Value before = score.Of(base, score.sample() && mask);
  return SmoothParameters(base, points, mask, score, before, pool).any;
}

}  // namespace batten::internal
