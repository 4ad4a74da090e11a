// SPDX-License-Identifier: MIT
#include "fitting/knots/knot_grid_selection.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <utility>

#include "batten/fitting/point_mask.h"
#include "batten/fitting/solve_linear.h"
#include "fitting/core/rounding.h"
#include "fitting/core/rules.h"
#include "fitting/core/stopwatch.h"
#include "fitting/knots/block_cross_validation.h"
#include "fitting/least_squares/fitting_bases.h"

namespace batten::internal {
namespace {

constexpr int kFineGrid = 1500;
constexpr int kRisesToStop = 3;
constexpr int kCellsAtLeastTried = 8;
constexpr double kBeyondChance = 4;           // standard deviations, for more than a single cell
constexpr Eigen::Index kManyPoints = 150000;  // a part of them tells where the ladder may begin
constexpr Eigen::Index kSample = 50000;

class Search {
 public:
  Search(const FittingProblem& problem,
         const GridLimits& limits,
         ThreadPool& pool,
         std::string stage = "cross-validation")
      : stage_(std::move(stage)), problem_(problem), limits_(limits), pool_(pool) {
    points_ = PointCount(problem);
    least_u_ = LeastCells(problem.basis_u(), limits.degree_u);
    least_v_ = LeastCells(problem.basis_v(), limits.degree_v);
    length_u_ = problem.basis_u().upper() - problem.basis_u().lower();
    length_v_ = problem.basis_v().upper() - problem.basis_v().lower();
    const double extent = problem.data().values.cwiseAbs().maxCoeff();
    exact_ = points_ * std::pow(kRelativelyEqual * extent, 2);
  }

  int Unknowns(int cells_u, int cells_v) const {
    return FreedomOfCells(problem_.basis_u(), limits_.degree_u, cells_u) *
               FreedomOfCells(problem_.basis_v(), limits_.degree_v, cells_v) -
           PoleConditionCount(LikeU(cells_u), LikeV(cells_v), problem_.poles());
  }

  // The least grid there is.
  std::pair<int, int> Least() const { return {least_u_, least_v_}; }

  bool Allowed(int cells_u, int cells_v) const {
    if (cells_u < least_u_ || cells_v < least_v_) return false;
    if (std::pair{cells_u, cells_v} == Least()) return true;
    // The net counts what a closed direction repeats and what a pole ties together too.
    const int net = (cells_u + limits_.degree_u) * (cells_v + limits_.degree_v);
    return net <= limits_.max_control_points &&
           Unknowns(cells_u, cells_v) * kLeastPointsPerControlPoint <= points_;
  }

  // Cells of nearly equal sides, cells² of them or so.
  std::pair<int, int> Square(double cells) const {
    const double root = std::sqrt(length_u_ / length_v_);
    return {std::max(least_u_, static_cast<int>(std::lround(cells * root))),
            std::max(least_v_, static_cast<int>(std::lround(cells / root)))};
  }

  double Score(int cells_u, int cells_v) {
    const auto [known, fresh] = scores_.try_emplace({cells_u, cells_v}, 0.0);
    if (!fresh) return known->second;
    const Stopwatch watch;
    const LinearSolution solution =
        SolveLinear(problem_.WithBases(LikeU(cells_u), LikeV(cells_v)), pool_);
    const double freedom = FreeVariables(cells_u, cells_v);
    // Below the rounding of exact data, finer grids have nothing left to gain.
    const double squares = std::max(solution.residual_squares, exact_);
    known->second = points_ * squares / (freedom * freedom);
    RoundSummary round;
    round.stage = stage_;
    round.control_points_u = cells_u + limits_.degree_u;
    round.control_points_v = cells_v + limits_.degree_v;
    round.rms = std::sqrt(solution.residual_squares / points_);
    round.score = known->second;
    round.seconds = watch.Seconds();
    rounds.push_back(round);
    tried.push_back({cells_u, cells_v, round.rms});
    return known->second;
  }

  double Squares(int cells_u, int cells_v) {
    const double freedom = FreeVariables(cells_u, cells_v);
    return Score(cells_u, cells_v) * freedom * freedom / points_;
  }

  bool Better(std::pair<int, int> b, std::pair<int, int> a) {
    return Score(b.first, b.second) < Score(a.first, a.second);
  }

  // Whether a grid leaves less than the least one by more than its control points do by chance: on
  // noise alone, the squares they take away have their number for a mean and twice that for a
  // variance.
  bool BeatsTheLeast(std::pair<int, int> cells) {
    const double more = Unknowns(cells.first, cells.second) - Unknowns(least_u_, least_v_);
    const double left = Squares(cells.first, cells.second);
    const double variance = left / std::max(1.0, points_ - Unknowns(cells.first, cells.second));
    return Squares(least_u_, least_v_) - left >
           variance * (more + kBeyondChance * std::sqrt(2 * more));
  }

  std::vector<RoundSummary> rounds;
  std::vector<TriedGrid> tried;

 private:
  SplineBasis LikeU(int cells) const {
    return FittingBasisLike(problem_.basis_u(), limits_.degree_u, cells);
  }
  SplineBasis LikeV(int cells) const {
    return FittingBasisLike(problem_.basis_v(), limits_.degree_v, cells);
  }

  double FreeVariables(int cells_u, int cells_v) const {
    return std::max(1.0, points_ - kFreedomFactor * Unknowns(cells_u, cells_v));
  }

  std::string stage_;
  const FittingProblem& problem_;
  const GridLimits& limits_;
  ThreadPool& pool_;
  int least_u_, least_v_;
  double points_, length_u_, length_v_, exact_;
  std::map<std::pair<int, int>, double> scores_;
};

// About so many of the data, evenly out of their order.
std::shared_ptr<const FittingData> EveryPart(const FittingData& data, Eigen::Index count) {
  const std::vector<Eigen::Index> some = SampleIndices(data.parameters.cols(), count, 1);
  auto part = std::make_shared<FittingData>();
  part->parameters = data.parameters(Eigen::all, some);
  part->values = data.values(Eigen::all, some);
  if (data.weights.size() > 0) part->weights = data.weights(some);
  return part;
}

// Tries grids from coarse to fine until the score has risen several times in a row; `enough` can
// stop it after a grid that is the best so far. From `first` cells on in either direction.
std::pair<int, int> ClimbLadder(Search& search,
                                double first,
                                const std::function<bool(std::pair<int, int>)>& enough,
                                const Progress& progress) {
  double cells = first;
  std::pair<int, int> best = cells > 1 ? search.Square(cells) : search.Least();
  int rises = 0;
  double previous = search.Score(best.first, best.second);
  for (;;) {
    cells = cells < 6 ? cells + 1 : std::max(cells + 1, std::round(cells * 1.22));
    const std::pair<int, int> grid = search.Square(cells);
    if (grid == best) continue;
    if (!search.Allowed(grid.first, grid.second)) return best;
    const double score = search.Score(grid.first, grid.second);
    rises = score >= previous ? rises + 1 : 0;
    previous = score;
    if (search.Better(grid, best)) {
      best = grid;
      if (enough(best)) return best;
    }
    Report(progress, "solve", std::min(0.9, cells / 40));
    if (rises >= kRisesToStop && cells >= kCellsAtLeastTried) return best;
  }
}

// Along each direction alone, then both, with steps that shrink to one cell.
std::pair<int, int> Descend(Search& search, std::pair<int, int> best, const Progress& progress) {
  for (bool moved = true; moved;) {
    moved = false;
    for (const double share : {0.2, 0.1, 0.0}) {
      // On a fine grid a single line more or less changes nothing that could be measured.
      if (share * std::max(best.first, best.second) < 1 &&
          search.Unknowns(best.first, best.second) > kFineGrid)
        continue;
      for (const auto& [du, dv] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}}) {
        const int step_u = std::max(1, static_cast<int>(share * best.first));
        const int step_v = std::max(1, static_cast<int>(share * best.second));
        const std::pair<int, int> grid{best.first + du * step_u, best.second + dv * step_v};
        if (!search.Allowed(grid.first, grid.second) || !search.Better(grid, best)) continue;
        best = grid;
        moved = true;
      }
    }
    Report(progress, "solve", 0.95);
  }
  return best;
}

// Cells in either direction that a part of very many points already asks for: all of them ask for
// no fewer.
double FirstOfLadder(const FittingProblem& problem,
                     const GridLimits& limits,
                     ThreadPool& pool,
                     std::vector<RoundSummary>& rounds,
                     const Progress& progress) {
  if (problem.size() < kManyPoints) return 1;
  const FittingProblem part = problem.WithData(EveryPart(problem.data(), kSample));
  Search search(part, limits, pool, "cross-validation of a part");
  const std::pair<int, int> best = ClimbLadder(
      search, 1, [](auto) { return false; }, progress);
  rounds = std::move(search.rounds);
  return std::sqrt(static_cast<double>(best.first) * best.second);
}

}  // namespace

GridChoice ChooseGrid(const FittingProblem& problem,
                      const GridLimits& limits,
                      ThreadPool& pool,
                      const Progress& progress) {
  Search search(problem, limits, pool);
  const auto coarsened = [&](std::pair<int, int> cells) {
    if (!limits.blocks || !Acts(Rule::kBlockValidation)) return cells;
    return CoarsenByBlockCv(
        problem,
        limits,
        cells,
        [&](std::pair<int, int> c) { return search.Squares(c.first, c.second); },
        pool,
        search.rounds,
        progress);
  };
  std::pair<int, int> scored{limits.near_cells_u, limits.near_cells_v}, grid = search.Least();
  bool settled = false;
  if (scored.first == 0 || !search.Allowed(scored.first, scored.second)) {
    // Noise that neighbours share leads up to many thousand control points: blocks are asked on the
    // way.
    bool asked = false;
    const auto follows_noise = [&](std::pair<int, int> cells) {
      if (asked || search.Unknowns(cells.first, cells.second) < kFineGrid) return false;
      asked = true;
      grid = coarsened(cells);
      return settled = grid != cells;
    };
    const double first = FirstOfLadder(problem, limits, pool, search.rounds, progress);
    scored = ClimbLadder(search, first, follows_noise, progress);
  }
  if (!settled) {
    scored = Descend(search, scored, progress);
    if (scored != search.Least() && !search.BeatsTheLeast(scored)) scored = search.Least();
    grid = coarsened(scored);
  }
  GridChoice choice;
  std::tie(choice.cells_u, choice.cells_v) = grid;
  choice.blocks_disagree = grid != scored;
  choice.score = search.Score(grid.first, grid.second);
  choice.rounds = std::move(search.rounds);
  choice.tried = std::move(search.tried);
  return choice;
}

}  // namespace batten::internal
