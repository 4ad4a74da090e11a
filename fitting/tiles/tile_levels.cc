// SPDX-License-Identifier: MIT
#include "fitting/tiles/tile_levels.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace batten::internal {
namespace {

// Points to a degree of freedom from which on cross-validation tells nets apart.
constexpr double kFewestPoints = 1.5;
constexpr int kLevelsInVain = 2;

// The greatest error of a shape that is missed over its rms: √3 of a slope, √2 of a wave.
constexpr double kPeak = 1.7;
// Standard errors by which a mean square may be above its expectation by chance.
constexpr double kChance = 4;

double Freedom(const TileNet& net, double filled) {
  const auto cells = static_cast<double>(net.errors.weights.size());
  return filled * static_cast<double>(net.rows.rows()) / cells;
}

double Score(double points, double squares, double freedom) {
  if (points < kFewestPoints * freedom) return std::numeric_limits<double>::infinity();
  const double left = points - freedom;
  return points * squares / (left * left);
}

std::vector<int> StripsOfSpans(const SplineBasis& basis, const TileAxis& axis) {
  std::vector<int> strips;
  for (const int span : basis.Spans())
    strips.push_back(axis.StripOf((basis.knots()[span] + basis.knots()[span + 1]) / 2));
  return strips;
}

// What the cells of a net tell of each tile (strips in u × in v).
struct TileSums {
  Eigen::ArrayXXd points, squares;
  Eigen::ArrayXXd filled;  // cells that hold points
  Eigen::ArrayXXd worst;  // the largest mean square of a cell beyond `noise_squared` and its chance
};

TileSums SumTiles(const TileNet& net,
                  const TileAxis& axis_u,
                  const TileAxis& axis_v,
                  double noise_squared) {
  const Eigen::ArrayXXd zero = Eigen::ArrayXXd::Zero(axis_u.strips(), axis_v.strips());
  TileSums sums{zero, zero, zero, zero};
  const std::vector<int> strips_u = StripsOfSpans(net.basis_u, axis_u),
                         strips_v = StripsOfSpans(net.basis_v, axis_v);
  const CellErrors& cells = net.errors;
  for (Eigen::Index j = 0; j < cells.weights.cols(); ++j) {
    for (Eigen::Index i = 0; i < cells.weights.rows(); ++i) {
      const double points = cells.weights(i, j);
      if (points <= 0) continue;
      const int s = strips_u[i], t = strips_v[j];
      sums.points(s, t) += points;
      sums.squares(s, t) += cells.squares(i, j);
      sums.filled(s, t) += 1;
      const double by_noise = noise_squared * (1 + kChance * std::sqrt(2 / points));
      sums.worst(s, t) = std::max(sums.worst(s, t), cells.squares(i, j) / points - by_noise);
    }
  }
  return sums;
}

}  // namespace

TileSearch::TileSearch(const FoldedPoints& points,
                       const TileAxis& axis_u,
                       const TileAxis& axis_v,
                       const TileSearchOptions& options,
                       ThreadPool& pool)
    : points_(points), u_(axis_u), v_(axis_v), options_(options), pool_(pool) {
  best_ = Eigen::ArrayXXi::Zero(u_.strips(), v_.strips());
  Eigen::ArrayXXd best =
      Eigen::ArrayXXd::Constant(u_.strips(), v_.strips(), std::numeric_limits<double>::infinity());
  const int finest = u_.finest_level(), p = points.basis_u.degree(), q = points.basis_v.degree();
  for (int level = 0; level <= std::min(finest, best_.maxCoeff() + kLevelsInVain); ++level) {
    done_ = static_cast<double>(level) / (finest + 1);
    nets_.push_back(
        Solve(u_.Basis(p, level), v_.Basis(q, level), nets_.empty() ? nullptr : &nets_.back()));
    Validate(level, best);
  }
  limited_ = finest > 0 && (best_ == finest).any();
  double squares = 0, left = 0;
  for (int level = 0; level < std::ssize(nets_); ++level) {
    const TileSums sums = SumTiles(nets_[level], u_, v_, 0);
    for (Eigen::Index k = 0; k < best_.size(); ++k) {
      if (best_(k) != level) continue;
      squares += sums.squares(k);
      left += std::max(0.0, sums.points(k) - Freedom(nets_[level], sums.filled(k)));
    }
  }
  noise_ = left > 0 ? std::sqrt(squares / left) : 0;
  wanted_ = best_;
  if (!options_.budget) return;
  const double allowed = *options_.budget / kPeak;
  for (int level = static_cast<int>(std::ssize(nets_)) - 1; level >= 0; --level) {
    const TileSums sums = SumTiles(nets_[level], u_, v_, noise_ * noise_);
    for (Eigen::Index k = 0; k < best_.size(); ++k) {
      const bool kept = std::sqrt(std::max(0.0, sums.worst(k))) <= allowed;
      if (kept && level < best_(k) && wanted_(k) == level + 1) wanted_(k) = level;
    }
  }
}

void TileSearch::Validate(int level, Eigen::ArrayXXd& best) {
  const TileSums sums = SumTiles(nets_.back(), u_, v_, 0);
  double score = 0;
  for (Eigen::Index k = 0; k < best.size(); ++k) {
    const double own =
        Score(sums.points(k), sums.squares(k), Freedom(nets_.back(), sums.filled(k)));
    score += sums.points(k) > 0 ? own * sums.points(k) : 0;
    if (!(own < best(k))) continue;
    best(k) = own;
    best_(k) = level;
  }
  const double points = sums.points.sum();
  rounds_.back().score = std::sqrt(score / points);
}

TileNet TileSearch::Solve(const SplineBasis& u, const SplineBasis& v, const TileNet* start) {
  const auto begin = std::chrono::steady_clock::now();
  TileNet net = SolveNet(points_, u, v, options_.smoothing, start, pool_, [&] {
    Report(options_.progress, "solve", done_);
  });
  RoundSummary round;
  round.stage = "tiles";
  round.control_points_u = u.size();
  round.control_points_v = v.size();
  round.rms = std::sqrt(net.errors.squares.sum() / net.errors.weights.sum());
  round.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  rounds_.push_back(round);
  return net;
}

bool TileSearch::Refine(const Eigen::ArrayXX<bool>& tiles) {
  bool any = false;
  for (Eigen::Index k = 0; k < best_.size(); ++k) {
    if (!tiles(k) || wanted_(k) >= best_(k)) continue;
    wanted_(k) += 1;
    any = true;
  }
  return any;
}

TileNet TileSearch::Solved() {
  const Eigen::ArrayXi of_u = wanted_.rowwise().maxCoeff(), of_v = wanted_.colwise().maxCoeff();
  const int low = std::min(of_u.minCoeff(), of_v.minCoeff());
  const bool even = low == std::max(of_u.maxCoeff(), of_v.maxCoeff());
  if (even) return nets_[low];
  const SplineBasis u = u_.Basis(points_.basis_u.degree(),
                                 {of_u.data(), of_u.data() + of_u.size()}),
                    v = v_.Basis(points_.basis_v.degree(),
                                 {of_v.data(), of_v.data() + of_v.size()});
  return Solve(u, v, &nets_[low]);
}

}  // namespace batten::internal
