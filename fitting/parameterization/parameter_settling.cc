// SPDX-License-Identifier: MIT
#include "fitting/parameterization/parameter_settling.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <utility>
#include <vector>

#include "batten/fitting/distances.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/solve_linear.h"
#include "fitting/joint/joint_optimization.h"
#include "fitting/knots/knot_grid_selection.h"
#include "fitting/least_squares/fitting_bases.h"

namespace batten::internal {
namespace {

constexpr Eigen::Index kMostSettled = 12000;  // points: more change no digit of the parameters
constexpr int kSettledDegree = 3;
constexpr double kSettledSmoothing = 1e-6;  // of linear fits and, as fairness, of joint steps
constexpr int kFirstSteps = 12, kNextSteps = 4, kLastSteps = 12;  // joint, of a net
constexpr double kGrowth = 1.35;  // of the cells in one direction
constexpr double kWorthWhile = 0.998;  // ratio of scores of a step that goes on
constexpr int kMostRounds = 16;
constexpr double kPointsPerUnknown = 6;
// Of the shorter side: the first net is the least that is so near to the points, whose parameters
// are wrong by more. A cubic cell that bends by one radian is off by 0.3 % of its radius; from
// fewer cells than the shape bends for, joint steps end far from it.
constexpr double kFirstMisfit = 0.01;
// Margins by which the net reaches beyond the points, so that their feet are inside it while it
// moves: those beyond its edge would pile up there.
constexpr double kRoomInMargins = 6;

// A net near the points.
struct Net {
  int cells_u, cells_v;
  FittingProblem problem;  // at the foot points
  Eigen::MatrixXd control_points;
  double score;  // generalised cross-validation of the distances
};

class Settler {
 public:
  Settler(FittingProblem start, ThreadPool& pool) : start_(std::move(start)), pool_(pool) {}

  std::optional<Net> Run(double shorter_side) const {
    const auto [cells_u, cells_v] = FirstCells(kFirstMisfit * shorter_side);
    std::optional<Net> best = At(start_, cells_u, cells_v, kFirstSteps);
    for (int round = 0; best && round < kMostRounds; ++round) {
      std::optional<Net> next;
      double gain = 0;
      for (const auto& [u, v] : {std::pair{Finer(best->cells_u), best->cells_v},
                                 std::pair{best->cells_u, Finer(best->cells_v)}}) {
        std::optional<Net> made = At(best->problem, u, v, kNextSteps);
        if (!made || made->score > kWorthWhile * best->score) continue;
        const double own = std::log(best->score / made->score) /
                           (made->problem.unknowns() - best->problem.unknowns());
        if (next && own <= gain) continue;
        gain = own;
        next = std::move(made);
      }
      if (!next) break;
      best = std::move(next);
    }
    if (!best) return best;
    std::optional<Net> last = At(best->problem, best->cells_u, best->cells_v, kLastSteps);
    return last && last->score < best->score ? last : best;
  }

 private:
  FittingProblem Over(const FittingProblem& at, int cells_u, int cells_v) const {
    return at.WithBases(FittingBasisLike(start_.basis_u(), kSettledDegree, cells_u),
                        FittingBasisLike(start_.basis_v(), kSettledDegree, cells_v));
  }

  // Grows a net of linear fits in the direction that pays more until it is near enough.
  std::pair<int, int> FirstCells(double near) const {
    const auto misfit = [&](int cells_u, int cells_v) {
      return SolveLinear(Over(start_, cells_u, cells_v), pool_).residual_squares;
    };
    const double enough = near * near * static_cast<double>(start_.size());
    int cells_u = 1, cells_v = 1;
    double least = misfit(1, 1);
    while (least > enough && Over(start_, cells_u, cells_v).unknowns() * kPointsPerUnknown <
                                 static_cast<double>(start_.size())) {
      const double by_u = misfit(Finer(cells_u), cells_v), by_v = misfit(cells_u, Finer(cells_v));
      const double worth_u = std::log(least / by_u) / std::log(Share(cells_u)),
                   worth_v = std::log(least / by_v) / std::log(Share(cells_v));
      if (std::min(by_u, by_v) > 0.999 * least && least < 4 * enough) break;
      (worth_u >= worth_v ? cells_u : cells_v) =
          Finer(worth_u >= worth_v ? cells_u : cells_v);
      least = worth_u >= worth_v ? by_u : by_v;
    }
    return {cells_u, cells_v};
  }

  // By which control points grow.
  static double Share(int cells) {
    return static_cast<double>(Finer(cells) + kSettledDegree) / (cells + kSettledDegree);
  }

  static int Finer(int cells) {
    return std::max(cells + 1, static_cast<int>(std::lround(kGrowth * cells)));
  }

  std::optional<Net> At(const FittingProblem& at, int cells_u, int cells_v, int steps) const {
    const FittingProblem problem = Over(at, cells_u, cells_v);
    const auto count = static_cast<double>(problem.size());
    if (problem.unknowns() * kPointsPerUnknown > count) return std::nullopt;
    JointOptions joint;
    joint.max_iterations = steps;
    joint.stop_at_noise = false;
    joint.least_gain = 1e-3;
    joint.fairness = kSettledSmoothing;
    const Eigen::MatrixXd net = SolveLinear(problem, pool_).coefficients;
    JointResult result = OptimizeJointly(problem, net, {}, joint, pool_);
    const double freedom = count - kFreedomFactor * problem.unknowns();
    if (std::getenv("BATTEN_TRACE"))
      std::fprintf(stderr, "   net %d x %d: rms %.4e, before %.4e, score %.6e, %d its\n", cells_u, cells_v, result.rms_after, result.rms_before, result.rms_after * result.rms_after * count * count / (freedom * freedom), result.iterations);
    const double score = result.rms_after * result.rms_after * count * count / (freedom * freedom);
    return Net{
        cells_u, cells_v, std::move(result.problem), std::move(result.control_points), score};
  }

  FittingProblem start_;
  ThreadPool& pool_;
};

}  // namespace

bool SettleParameters(Parameterization& base,
                      const PointCloud& points,
                      const PointMask& mask,
                      const PointMask& sample,
                      double margin,
                      ThreadPool& pool) {
  std::vector<Eigen::Index> all, some;
  for (Eigen::Index k = 0; k < mask.size(); ++k) {
    if (!mask[k]) continue;
    all.push_back(k);
    if (sample[k]) some.push_back(k);
  }
  PointMask chosen = PointMask::Constant(mask.size(), false);
  const auto count = std::min(kMostSettled, static_cast<Eigen::Index>(some.size()));
  for (Eigen::Index k = 0; k < count; ++k)
    chosen[some[static_cast<size_t>(k * static_cast<Eigen::Index>(some.size()) / count)]] = true;
  if (count == 0) return false;
  const double room = kRoomInMargins * margin;
  Parameterization roomy = base;
  roomy.parameters.array() += room;
  roomy.length_u += 2 * room;
  roomy.length_v += 2 * room;
  const FittingProblem problem =
      roomy.ProblemOf(points, chosen, kSettledDegree, kSettledDegree, kSettledSmoothing);
  const std::optional<Net> net = Settler(problem, pool).Run(std::min(base.length_u, base.length_v));
  if (!net) return false;
  const NurbsSurface surface(
      net->problem.basis_u(), net->problem.basis_v(), net->control_points);
  const Eigen::MatrixXd feet = DistancesFrom(surface,
                                             points.points()(Eigen::all, all),
                                             roomy.parameters(Eigen::all, all),
                                             pool)
                                   .parameters;
  if (!feet.allFinite()) return false;
  const Eigen::Vector2d low = feet.rowwise().minCoeff(), high = feet.rowwise().maxCoeff();
  base.parameters(Eigen::all, all) = (feet.colwise() - low).array() + margin;
  base.length_u = high[0] - low[0] + 2 * margin;
  base.length_v = high[1] - low[1] + 2 * margin;
  for (auto place : base.parameters.colwise())
    place = place.cwiseMax(0).cwiseMin(Eigen::Vector2d(base.length_u, base.length_v));
  return true;
}

}  // namespace batten::internal
