// SPDX-License-Identifier: MIT
// How fine a net each tile wants.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "batten/fitting/fit_report.h"
#include "batten/fitting/progress.h"
#include "fitting/tiles/tile_axis.h"
#include "fitting/tiles/tile_system.h"

namespace batten::internal {

struct TileSearchOptions {
  double smoothing;
  std::optional<double> budget;  // of what the shape of a cell may miss, beside noise
  Progress progress;
};

// Solves the nets of all tiles on one level, coarse to fine, until two levels in a row are better
// in no tile.
class TileSearch {
 public:
  TileSearch(const FoldedPoints& points,
             const TileAxis& axis_u,
             const TileAxis& axis_v,
             const TileSearchOptions& options,
             ThreadPool& pool);

  // Whether a tile wants the finest level there is.
  bool limited() const { return limited_; }
  // Standard deviation of points about the best nets.
  double noise() const { return noise_; }
  const std::vector<RoundSummary>& rounds() const { return rounds_; }

  // One level finer in tiles that are not yet at their best by cross-validation. Returns whether
  // one is.
  bool Refine(const Eigen::ArrayXX<bool>& tiles);

  // The net in which each strip has the finest level that one of its tiles wants.
  TileNet Solved();

 private:
  TileNet Solve(const SplineBasis& u, const SplineBasis& v, const TileNet* start);
  void Validate(int level, Eigen::ArrayXXd& best);

  const FoldedPoints& points_;
  const TileAxis &u_, &v_;
  const TileSearchOptions options_;
  ThreadPool& pool_;
  std::vector<TileNet> nets_;  // by level
  // The level, for each tile, of the least error of left-out points as generalised cross-validation
  // has it [Craven & Wahba 1979]; the coarsest that keeps the budget, if there is one.
  Eigen::ArrayXXi best_, wanted_;
  bool limited_ = false;
  double noise_ = 0, done_ = 0;
  std::vector<RoundSummary> rounds_;
};

}  // namespace batten::internal
