// SPDX-License-Identifier: MIT
#include "fitting/parameterization/parameter_settling.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/solve_linear.h"
#include "batten/fitting/statistics.h"
#include "fitting/core/mask_indices.h"
#include "fitting/core/shared_constants.h"
#include "fitting/joint/joint_optimization.h"
#include "fitting/knots/knot_grid_selection.h"
#include "fitting/least_squares/fitting_bases.h"
#include "fitting/parameterization/parameter_smoothing.h"

namespace batten::internal {
namespace {

constexpr Eigen::Index kMostSettled = 12000;  // points: more change no digit of the parameters
// Of linear fits and, as fairness, of joint steps: less leaves tangential wrinkles, more bends the
// surface off its points. [measured: kind_fitting; ratios within 10 % from 3e-6 to 3e-5]
constexpr double kSettledSmoothing = 1e-5;
// Joint steps at a net. Few while it grows: a joint step may move control points along the surface,
// too, and so has up to three times the freedom of a linear fit; damping holds it only while steps
// are few, and more of them follow the noise. The last net has to undo what straight sides cost.
// [measured: kind_fitting; ten times as many at first: errors 1.2 to 1.5 times as large; half as
// many last: 1.1 times]
constexpr int kFirstSteps = 2, kNextSteps = 1, kLastSteps = 10;
constexpr Eigen::Index kMostLast = 60000;  // points of the last net, whose errors stay
constexpr double kLeastGain = 1e-5;        // relative, of the cost: joint steps end
constexpr int kStraightened = 3;           // times: more gain nothing
constexpr double kGrowth = 1.35;           // of the cells in one direction
constexpr double kWorthWhile = 0.9997;     // ratio of scores of a step that goes on
constexpr int kMostRounds = 16;
constexpr double kPointsPerUnknown = 6;
// Of the shorter side: the first net is the least that is so near to the points, whose parameters
// are wrong by more. A cubic cell that bends by one radian is off by 0.3 % of its radius; from
// fewer cells than the shape bends for, joint steps end far from it.
constexpr double kFirstMisfit = 0.01;
constexpr double kBinInSpacings = 4;  // wherein the last point is a quarter of one from the side
constexpr double kFilled = 0.7;       // of the usual count: a bin that a side ends in has less
constexpr int kPlaces = 400;          // of a side's table
// Margins by which the net reaches beyond the points, so that their feet are inside it while it
// moves: those beyond its edge would pile up there.
constexpr double kRoomInMargins = 6;

// A net near the points.
struct Net {
  int cells_u, cells_v;
  FittingProblem problem;  // at the foot points
  Eigen::MatrixXd control_points;
  double score;  // generalised cross-validation of the distances

  NurbsSurface Surface() const { return {problem.basis_u(), problem.basis_v(), control_points}; }
};

class Settler {
 public:
  Settler(FittingProblem start, ThreadPool& pool) : start_(std::move(start)), pool_(pool) {}

  // None where it is behind the rival (null: there is none), or points are too few.
  std::optional<Net> Run(double shorter_side, const BaseScore::Value* rival) const {
    const auto [cells_u, cells_v] = FirstCells(kFirstMisfit * shorter_side);
    std::optional<Net> best = At(start_, cells_u, cells_v, kFirstSteps);
    for (int round = 0; best && round < kMostRounds; ++round) {
      if (IsBehind(*best, rival)) return std::nullopt;
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
    if (best && IsBehind(*best, rival)) return std::nullopt;
    return best;
  }

  // The net of so many cells near the problem's points after at most so many joint steps; none
  // where points are too few for it.
  std::optional<Net> At(const FittingProblem& at, int cells_u, int cells_v, int steps) const {
    const FittingProblem problem = OverCells(at, cells_u, cells_v);
    const auto count = static_cast<double>(problem.size());
    if (problem.unknowns() * kPointsPerUnknown > count) return std::nullopt;
    JointOptions joint;
    joint.max_iterations = steps;
    joint.stop_at_noise = false;
    joint.least_gain = kLeastGain;
    joint.fairness = kSettledSmoothing;
    const Eigen::MatrixXd net = SolveLinear(problem, pool_).coefficients;
    JointResult result = OptimizeJointly(problem, net, {}, joint, pool_);
    const double freedom = count - kFreedomFactor * problem.unknowns();
    const double score = result.rms_after * result.rms_after * count * count / (freedom * freedom);
    return Net{
        cells_u, cells_v, std::move(result.problem), std::move(result.control_points), score};
  }

 private:
  static bool IsBehind(const Net& net, const BaseScore::Value* rival) {
    return rival && net.problem.unknowns() > rival->control_points && net.score > rival->score;
  }

  // Grows a net of linear fits in the direction that pays more until it is near enough.
  std::pair<int, int> FirstCells(double near) const {
    const auto misfit = [&](int cells_u, int cells_v) {
      return SolveLinear(OverCells(start_, cells_u, cells_v), pool_).residual_squares;
    };
    const double enough = near * near * static_cast<double>(start_.size());
    int cells_u = 1, cells_v = 1;
    double least = misfit(1, 1);
    while (least > enough && OverCells(start_, cells_u, cells_v).unknowns() * kPointsPerUnknown <
                                 static_cast<double>(start_.size())) {
      const double by_u = misfit(Finer(cells_u), cells_v), by_v = misfit(cells_u, Finer(cells_v));
      const double worth_u = std::log(least / by_u) / std::log(Share(cells_u)),
                   worth_v = std::log(least / by_v) / std::log(Share(cells_v));
      if (std::min(by_u, by_v) > 0.999 * least && least < 4 * enough) break;
      (worth_u >= worth_v ? cells_u : cells_v) = Finer(worth_u >= worth_v ? cells_u : cells_v);
      least = worth_u >= worth_v ? by_u : by_v;
    }
    return {cells_u, cells_v};
  }

  // By which control points grow.
  static double Share(int cells) {
    return static_cast<double>(Finer(cells) + kProbeDegree) / (cells + kProbeDegree);
  }

  static int Finer(int cells) {
    return std::max(cells + 1, static_cast<int>(std::lround(kGrowth * cells)));
  }

  FittingProblem start_;
  ThreadPool& pool_;
};

// At most so many of the points under the mask, evenly by index.
PointMask SomeUnder(const PointMask& mask, Eigen::Index most) {
  PointMask some = PointMask::Constant(mask.size(), false);
  some(IndicesOf(mask, most)).setConstant(true);
  return some;
}

// The least and the largest parameter d of the points where the other one is at places
// 0 … kPlaces of its range, as smooth curves of `cells` spans.
Eigen::Matrix2Xd LimitsOf(const Eigen::Matrix2Xd& parameters,
                          const Eigen::Vector2d& lengths,
                          int d,
                          int cells,
                          ThreadPool& pool) {
  const double along = lengths[1 - d];
  const double spacing = std::sqrt(lengths.prod() / static_cast<double>(parameters.cols()));
  const auto bins =
      std::clamp<Eigen::Index>(std::lround(along / (kBinInSpacings * spacing)), 8, 1000);
  Eigen::Matrix2Xd limits(2, bins);
  limits.row(0).setConstant(HUGE_VAL);
  limits.row(1).setConstant(-HUGE_VAL);
  std::vector<double> counts(static_cast<size_t>(bins), 0);
  for (const auto place : parameters.colwise()) {
    const auto bin = std::clamp<Eigen::Index>(
        static_cast<Eigen::Index>(place[1 - d] / along * static_cast<double>(bins)), 0, bins - 1);
    ++counts[static_cast<size_t>(bin)];
    limits(0, bin) = std::min(limits(0, bin), place[d]);
    limits(1, bin) = std::max(limits(1, bin), place[d]);
  }
  std::vector<Eigen::Index> filled;
  const double least = kFilled * Median(counts);  // at the ends, sides across cut some off
  for (Eigen::Index k = 1; k + 1 < bins; ++k)
    if (counts[static_cast<size_t>(k)] >= least && limits(0, k) < limits(1, k)) filled.push_back(k);
  auto data = std::make_shared<FittingData>();
  data->values = limits(Eigen::all, filled);
  data->parameters = Eigen::Matrix2Xd::Zero(2, data->values.cols());
  for (size_t k = 0; k < filled.size(); ++k)
    data->parameters(0, static_cast<Eigen::Index>(k)) =
        (static_cast<double>(filled[k]) + 0.5) * along / static_cast<double>(bins);
  const int spans = std::clamp(cells, 1, std::max(1, static_cast<int>(filled.size()) / 4));
  const FittingProblem problem(
      FittingBasis(kProbeDegree, spans, 0, along), data, kSurfaceSmoothing);
  const NurbsCurve<2> curve(problem.basis_u(), SolveLinear(problem, pool).coefficients);
  Eigen::Matrix2Xd table(2, kPlaces + 1);
  for (int k = 0; k <= kPlaces; ++k) table.col(k) = curve.At(along * k / kPlaces);
  return table;
}

// Moves the parameters so that the points fill the rectangle up to the margin: its sides, which
// the settled net knows nothing of, become straight. False where sides meet.
bool StraightenSides(const Net& net,
                     const std::vector<Eigen::Index>& all,
                     double margin,
                     Parameterization& base,
                     ThreadPool& pool) {
  const Eigen::Vector2d lengths(base.length_u, base.length_v);
  const Eigen::Matrix2Xd before = base.parameters(Eigen::all, all);
  for (int d = 0; d < 2; ++d) {
    const Eigen::Matrix2Xd limits =
        LimitsOf(before, lengths, d, d == 0 ? net.cells_v : net.cells_u, pool);
    const double least = 0.2 * lengths[d];
    if ((limits.row(1) - limits.row(0)).minCoeff() < least) return false;
    for (size_t k = 0; k < all.size(); ++k) {
      const auto own = static_cast<Eigen::Index>(k);
      const double at = std::clamp(before(1 - d, own) / lengths[1 - d], 0.0, 1.0) * kPlaces;
      const auto cell = std::min<Eigen::Index>(static_cast<Eigen::Index>(at), kPlaces - 1);
      const Eigen::Vector2d ends = limits.col(cell) + (at - static_cast<double>(cell)) *
                                                          (limits.col(cell + 1) - limits.col(cell));
      base.parameters(d, all[k]) =
          margin + (before(d, own) - ends[0]) / (ends[1] - ends[0]) * (lengths[d] - 2 * margin);
    }
  }
  for (auto place : base.parameters.colwise()) place = place.cwiseMax(0).cwiseMin(lengths);
  return true;
}

}  // namespace

bool SettleParameters(Parameterization& base,
                      const PointCloud& points,
                      const PointMask& mask,
                      const PointMask& sample,
                      double margin,
                      const BaseScore::Value* rival,
                      ThreadPool& pool) {
  const std::vector<Eigen::Index> all = IndicesOf(mask);
  const PointMask few = SomeUnder(mask && sample, kMostSettled), most = SomeUnder(mask, kMostLast);
  if (!few.any()) return false;
  const double room = kRoomInMargins * margin;
  Parameterization settled = base;
  settled.parameters.array() += room;
  settled.length_u += 2 * room;
  settled.length_v += 2 * room;
  const auto problem_of = [&](const PointMask& some) {
    return settled.ProblemOf(points, some, kProbeDegree, kProbeDegree, kSettledSmoothing);
  };
  const std::optional<Net> net =
      Settler(problem_of(few), pool).Run(std::min(base.length_u, base.length_v), rival);
  if (!net) return false;
  MoveToFeet(net->Surface(), points, all, settled, pool);
  // The rectangle now ends at the points, and a net over it brings them all to rest.
  const Eigen::Matrix2Xd feet = settled.parameters(Eigen::all, all);
  const Eigen::Vector2d low = feet.rowwise().minCoeff().array() - margin,
                        sides = feet.rowwise().maxCoeff().array() + margin - low.array();
  settled.length_u = sides[0];
  settled.length_v = sides[1];
  for (auto place : settled.parameters.colwise()) place = (place - low).cwiseMax(0).cwiseMin(sides);
  // The first time corners are not yet where sides meet.
  for (int time = 0; time < kStraightened; ++time) {
    if (!StraightenSides(*net, all, margin, settled, pool)) return false;
    const FittingProblem whole = problem_of(time + 1 < kStraightened ? few : most);
    const std::optional<Net> last =
        Settler(whole, pool).At(whole, net->cells_u, net->cells_v, kLastSteps);
    if (!last) return false;
    MoveToFeet(last->Surface(), points, all, settled, pool);
    if (!settled.parameters.allFinite()) return false;
  }
  base = std::move(settled);
  base.settled_cells_u = net->cells_u;
  base.settled_cells_v = net->cells_v;
  return true;
}

}  // namespace batten::internal
