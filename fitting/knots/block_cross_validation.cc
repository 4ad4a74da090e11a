// SPDX-License-Identifier: MIT
#include "fitting/knots/block_cross_validation.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "batten/fitting/solve_linear.h"
#include "fitting/core/shared_constants.h"
#include "fitting/core/stopwatch.h"
#include "fitting/knots/block_validation.h"
#include "fitting/least_squares/fitting_bases.h"

namespace batten::internal {
namespace {

constexpr double kBlockInSpacings = 8;
constexpr double kLeastBlocks = 40;    // fewer blocks are not conclusive
constexpr double kWidening = 1.5;      // of blocks, from one round to the next
constexpr double kWidestBlock = 1.2;   // in cells: a grid cannot bridge wider gaps
constexpr double kCoarser = 0.83;      // cells in a direction, from one grid to the next
constexpr double kStep = 0.9;          // cells in one direction alone, around the best
constexpr double kClearly = 2;         // standard errors
constexpr double kClearlyFewer = 0.8;  // control points
constexpr double kNoiseAtMost = 4;     // times the squares that are left by the finer grid
constexpr double kEverywhere = 0.25;   // share of the blocks that show noise
constexpr int kGridsToGiveUp = 2;

using Cells = std::pair<int, int>;

Cells Scaled(Cells cells, double u, double v) {
  return {std::max(1, static_cast<int>(std::lround(u * cells.first))),
          std::max(1, static_cast<int>(std::lround(v * cells.second)))};
}

// Grids compared by how they foresee blocks of one width.
class BlockSearch {
 public:
  BlockSearch(const FittingProblem& problem,
              const GridLimits& limits,
              double width,
              ThreadPool& pool,
              std::vector<RoundSummary>& rounds)
      : problem_(problem),
        limits_(limits),
        pool_(pool),
        rounds_(rounds),
        validation_(problem, width) {}

  double Error(Cells cells) { return Errors(cells).sum(); }

  // How much less `a` errs than `b`, in standard errors from block to block.
  double Lead(Cells a, Cells b) {
    const Eigen::ArrayXd gain = Errors(b).array() - Errors(a).array();
    const double spread = std::sqrt((gain - gain.mean()).square().sum());
    return spread > 0 ? gain.sum() / spread : 0;
  }

  // In how large a share of the blocks two grids differ: 1 if by as much in every block. Noise is
  // everywhere; what a cliff or another feature makes them differ by is in few blocks.
  double ShareThatDiffers(Cells a, Cells b) {
    const Eigen::VectorXd squares = (Fitted(a) - Fitted(b)).colwise().squaredNorm().transpose();
    Eigen::ArrayXd mean = Eigen::ArrayXd::Zero(validation_.blocks()), count = mean;
    for (Eigen::Index k = 0; k < squares.size(); ++k) {
      const int block = validation_.block_of()[static_cast<size_t>(k)];
      mean[block] += squares[k];
      count[block] += 1;
    }
    mean /= count;
    const double sum = mean.sum();
    return sum > 0 ? sum * sum / (static_cast<double>(mean.size()) * mean.square().sum()) : 1;
  }

  // The best of a grid and ever coarser ones, and of the best one's neighbours if it is another.
  Cells Best(const Cells first) {
    Cells best = first;
    int worse = 0;
    for (double share = kCoarser; worse < kGridsToGiveUp; share *= kCoarser) {
      const Cells grid = Scaled(first, share, share);
      worse = Error(grid) < Error(best) ? 0 : worse + 1;
      if (worse == 0) best = grid;
      if (grid == std::pair{1, 1}) break;
    }
    if (best == first) return best;
    for (const auto& [du, dv] :
         {std::pair{kStep, 1.0}, {1.0, kStep}, {1 / kStep, 1.0}, {1.0, 1 / kStep}}) {
      const Cells grid = Scaled(best, du, dv);
      if (Error(grid) < Error(best)) best = grid;
    }
    return best;
  }

 private:
  FittingProblem OnGrid(Cells cells) const {
    return problem_.WithBases(FittingBasisLike(problem_.basis_u(), limits_.degree_u, cells.first),
                              FittingBasisLike(problem_.basis_v(), limits_.degree_v, cells.second));
  }

  Eigen::MatrixXd Fitted(Cells cells) const {
    const FittingProblem on_grid = OnGrid(cells);
    return EvaluateAt(on_grid, SolveLinear(on_grid, pool_).coefficients, pool_);
  }

  const Eigen::VectorXd& Errors(Cells cells) {
    const auto [known, fresh] = errors_.try_emplace(cells);
    if (!fresh) return known->second;
    const Stopwatch watch;
    const FittingProblem on_grid = OnGrid(cells);
    known->second = validation_.Errors(on_grid.basis_u(), on_grid.basis_v(), pool_);
    RoundSummary round;
    round.stage = "block validation";
    round.control_points_u = cells.first + limits_.degree_u;
    round.control_points_v = cells.second + limits_.degree_v;
    round.score = known->second.sum() / static_cast<double>(problem_.size());
    round.rms = std::sqrt(round.score);
    round.seconds = watch.Seconds();
    rounds_.push_back(round);
    return known->second;
  }

  const FittingProblem& problem_;
  const GridLimits& limits_;
  ThreadPool& pool_;
  std::vector<RoundSummary>& rounds_;
  BlockValidation validation_;
  std::map<Cells, Eigen::VectorXd> errors_;
};

// The longer side of a cell: a hole no longer than that leaves no control point alone.
double CellSide(const FittingProblem& problem, Cells cells) {
  return std::max((problem.basis_u().upper() - problem.basis_u().lower()) / cells.first,
                  (problem.basis_v().upper() - problem.basis_v().lower()) / cells.second);
}

// The cells themselves, or as many fewer as make them wide enough for blocks of a width.
Cells WideEnough(const FittingProblem& problem, Cells cells, double width) {
  const double share = std::min(1.0, kWidestBlock * CellSide(problem, cells) / width);
  return share < 1 ? Cells{std::max(1, static_cast<int>(share * cells.first)),
                           std::max(1, static_cast<int>(share * cells.second))}
                   : cells;
}

int Unknowns(const GridLimits& limits, Cells cells) {
  return (cells.first + limits.degree_u) * (cells.second + limits.degree_v);
}

}  // namespace

Cells CoarsenByBlockCv(const FittingProblem& problem,
                       const GridLimits& limits,
                       const Cells scored,
                       const std::function<double(Cells)>& squares,
                       ThreadPool& pool,
                       std::vector<RoundSummary>& rounds,
                       const Progress& progress) {
  const double spacing = ParameterSpacing(problem), points = PointCount(problem);
  double width = spacing * std::min(kBlockInSpacings, std::sqrt(points / kLeastBlocks));
  Cells grid = scored;
  while (grid != Cells{1, 1}) {
    const Cells first = WideEnough(problem, grid, width);
    const auto mere_noise = [&](Cells cells) {
      return squares(cells) <= std::min(kNoiseAtMost * squares(scored),
                                        points * std::pow(kSharedAtMost * limits.noise, 2));
    };
    if (!mere_noise(first)) break;
    BlockSearch blocks(problem, limits, width, pool, rounds);
    const Cells best = blocks.Best(first);
    Report(progress, "solve", 0.97);
    if (Unknowns(limits, best) > kClearlyFewer * Unknowns(limits, grid) ||
        blocks.Lead(best, grid) < kClearly || !mere_noise(best) ||
        blocks.ShareThatDiffers(best, grid) < kEverywhere) {
      break;
    }
    grid = best;
    width *= kWidening;
    if (points < kLeastBlocks * std::pow(width / spacing, 2)) break;
  }
  return grid;
}

}  // namespace batten::internal
