// SPDX-License-Identifier: MIT
#include "fitting/parameterization/parameter_smoothing.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "batten/fitting/distances.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/solve_linear.h"
#include "fitting/core/mask_indices.h"
#include "fitting/core/shared_constants.h"
#include "fitting/least_squares/fitting_bases.h"

namespace batten::internal {
namespace {

// Shares of the cells chosen by cross-validation, in u and v.
constexpr std::pair<double, double> kShares[] = {
    {0.35, 0.35}, {0.5, 0.5}, {0.7, 0.7}, {1, 0.5}, {0.5, 1}, {1, 1}};
constexpr double kSmoothedClearlyBetter = 0.9995;
constexpr double kSmoothedAsGood = 0.9999;  // if there are clearly fewer control points

int Cells(double share, int cells) {
  return std::max(1, static_cast<int>(std::lround(share * cells)));
}

}  // namespace

void MoveToFeet(const NurbsSurface& surface,
                const PointCloud& points,
                const std::vector<Eigen::Index>& some,
                Parameterization& base,
                ThreadPool& pool) {
  base.parameters(Eigen::all, some) =
      DistancesFrom(
          surface, points.points()(Eigen::all, some), base.parameters(Eigen::all, some), pool)
          .parameters;
}

std::optional<BaseScore::Value> SmoothParameters(Parameterization& base,
                                                 const PointCloud& points,
                                                 const PointMask& mask,
                                                 const BaseScore& score,
                                                 const BaseScore::Value& before,
                                                 ThreadPool& pool) {
  const PointMask some = score.sample() && mask;
  const std::vector<Eigen::Index> sample = IndicesOf(some);
  Parameterization current = base;
  BaseScore::Value best = before;
  std::optional<NurbsSurface> chosen;
  for (const auto& [share_u, share_v] : kShares) {
    const FittingProblem problem =
        OverCells(current.ProblemOf(points, some, kProbeDegree, kProbeDegree, kSurfaceSmoothing),
                  Cells(share_u, before.cells_u),
                  Cells(share_v, before.cells_v));
    NurbsSurface surface =
        base.Surface(problem.basis_u(), problem.basis_v(), SolveLinear(problem, pool).coefficients);
    Parameterization moved = current;
    MoveToFeet(surface, points, sample, moved, pool);
    const BaseScore::Value now = score.Near(moved, some, best);
    const bool fewer = now.control_points < kClearlyFewer * best.control_points;
    if (now.score >= (fewer ? kSmoothedAsGood : kSmoothedClearlyBetter) * best.score) continue;
    best = now;
    current = std::move(moved);
    chosen = std::move(surface);
  }
  if (!chosen) return std::nullopt;
  MoveToFeet(*chosen, points, IndicesOf(mask), base, pool);
  return best;
}

}  // namespace batten::internal
