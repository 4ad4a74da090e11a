// SPDX-License-Identifier: MIT
#include "fitting/grid/grid_knot_placement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "batten/geometry/knot_vectors.h"
#include "fitting/grid/line_least_squares.h"
#include "fitting/grid/value_span.h"
#include "fitting/knots/data_knots.h"

namespace batten::internal {
namespace {

constexpr int kRounds = 16, kPruningRounds = 4;
constexpr int kRoundsFromOthers = 6;  // where the breaks of nearly as many spans are known
constexpr double kNear = 0.5;         // share of the spans
constexpr double kDamping = 0.5;
constexpr double kLeastBreakShare = 1e-3;  // of the largest error: no span grows without limit
constexpr int kRetreats = 5;               // halvings of a move that leaves a span without samples
constexpr double kSamplesPerSpan = 2;

// Breaks of a given number of spans, distributed as the given increasing values are.
std::vector<double> Resampled(std::span<const double> breaks, int spans) {
  std::vector<double> result{breaks.front()};
  const size_t last = breaks.size() - 1;
  for (int k = 1; k < spans; ++k) {
    const double place = static_cast<double>(k) * static_cast<double>(last) / spans;
    const auto before = std::min(static_cast<size_t>(place), last - 1);
    const double share = place - static_cast<double>(before);
    result.push_back((1 - share) * breaks[before] + share * breaks[before + 1]);
  }
  result.push_back(breaks.back());
  return result;
}

}  // namespace

GridKnotSearch::GridKnotSearch(int degree,
                               Eigen::VectorXd parameters,
                               Eigen::Matrix3Xd points,
                               double lower,
                               double upper,
                               bool closed,
                               bool meet_ends)
    : degree_(degree),
      parameters_(std::move(parameters)),
      points_(std::move(points)),
      lower_(lower),
      upper_(upper),
      closed_(closed),
      meet_ends_(meet_ends) {}

int GridKnotSearch::SpansBelow(int control_points) const {
  const auto determined =
      static_cast<int>(static_cast<double>(parameters_.size()) / kSamplesPerSpan);
  return std::min(determined, control_points - 1 - ControlPoints(0));
}

SplineBasis GridKnotSearch::BasisOf(const std::vector<double>& breaks) const {
  return closed_ ? PeriodicKnots(degree_, breaks) : SplineBasis::Clamped(degree_, breaks);
}

std::vector<double> GridKnotSearch::EqualShares(int spans) const {
  std::vector<double> breaks = Resampled(Values(parameters_), spans);
  breaks.front() = lower_;
  breaks.back() = upper_;
  return breaks;
}

std::vector<double> GridKnotSearch::LineErrors(const std::vector<double>& breaks,
                                               ThreadPool& pool) const {
  const SplineBasis basis = BasisOf(breaks);
  const std::span<const double> t = Values(parameters_);
  if (!closed_ && FirstUnsupported(basis, t)) return {};
  const LineLeastSquares squares(basis, t, meet_ends_);
  if (!squares.regular()) return {};
  const Eigen::Index curves = points_.cols() / parameters_.size(), width = 3 * curves;
  Eigen::Matrix3Xd control(3, squares.size() * curves), values(3, points_.cols());
  squares.SolveLines(points_.data(), width, control.data(), pool);
  squares.EvaluateLines(control.data(), width, values.data());
  values -= points_;
  std::vector<double> errors;
  for (Eigen::Index k = 0; k < parameters_.size(); ++k) {
    const double square = values.middleCols(k * curves, curves).colwise().squaredNorm().maxCoeff();
    errors.push_back(std::sqrt(square));
  }
  return errors;
}

std::vector<double> GridKnotSearch::Moved(const std::vector<double>& breaks,
                                          const std::vector<double>& errors) const {
  const size_t spans = breaks.size() - 1;
  std::vector<double> most(spans, 0.0);
  size_t span = 0;
  for (size_t k = 0; k < errors.size(); ++k) {
    while (span + 1 < spans && parameters_[static_cast<Eigen::Index>(k)] >= breaks[span + 1])
      ++span;
    most[span] = std::max(most[span], errors[k]);
  }
  const double least = kLeastBreakShare * *std::max_element(most.begin(), most.end());
  // The share of the new breaks that each span gets.
  std::vector<double> worth(spans);
  double whole = 0;
  for (size_t k = 0; k < spans; ++k) {
    worth[k] = std::pow(std::max(most[k], least), kDamping / (degree_ + 1));
    whole += worth[k];
  }
  std::vector<double> moved{breaks.front()};
  double before = 0;
  size_t from = 0;
  for (size_t k = 1; k < spans; ++k) {
    const double place = whole * static_cast<double>(k) / static_cast<double>(spans);
    while (from + 1 < spans && before + worth[from] < place) before += worth[from++];
    const double share = std::clamp((place - before) / worth[from], 0.0, 1.0);
    moved.push_back(breaks[from] + share * (breaks[from + 1] - breaks[from]));
  }
  moved.push_back(breaks.back());
  return moved;
}

const GridKnotPlacement* GridKnotSearch::NearestTo(int spans) const {
  const GridKnotPlacement* nearest = nullptr;
  int apart = 0;
  for (const auto& [count, found] : found_) {
    const int off = std::abs(count - spans);
    if (off == 0 || off > kNear * spans || !std::isfinite(found.error)) continue;
    if (nearest && off >= apart) continue;
    nearest = &found;
    apart = off;
  }
  return nearest;
}

const GridKnotPlacement& GridKnotSearch::Best(int spans, ThreadPool& pool) {
  const auto [place, is_new] =
      found_.try_emplace(spans, GridKnotPlacement{{}, std::numeric_limits<double>::infinity()});
  GridKnotPlacement& best = place->second;
  if (!is_new) return best;
  const GridKnotPlacement* near = NearestTo(spans);
  best.breaks = near ? Resampled(near->breaks, spans) : EqualShares(spans);
  std::vector<double> breaks = best.breaks, errors = LineErrors(breaks, pool);
  if (near && errors.empty()) errors = LineErrors(breaks = best.breaks = EqualShares(spans), pool);
  const int rounds = near ? kRoundsFromOthers : kRounds;
  for (int round = 0, idle = 0; round < rounds && idle < kPruningRounds; ++round, ++idle) {
    if (errors.empty()) break;
    const double error = *std::max_element(errors.begin(), errors.end());
    if (error < best.error) {
      best = {breaks, error};
      idle = 0;
    }
    if (!(error > 0) || spans == 1) break;
    std::vector<double> moved = Moved(breaks, errors);
    errors = LineErrors(moved, pool);
    for (int k = 0; k < kRetreats && errors.empty(); ++k) {
      for (size_t i = 0; i < moved.size(); ++i) moved[i] = (moved[i] + breaks[i]) / 2;
      errors = LineErrors(moved, pool);
    }
    breaks = std::move(moved);
  }
  return best;
}

int GridKnotSearch::SpansFor(double tolerance, int most, ThreadPool& pool) {
  const auto keeps = [&](int spans) { return Best(spans, pool).error <= tolerance; };
  int low = closed_ ? degree_ + 1 : 1, high = low;  // below `low` the tolerance is not kept
  while (high <= most && !keeps(high)) {
    low = high + 1;
    high = 2 * high;
  }
  // If no power of two keeps the tolerance, `most` spans may.
  if (high > most) {
    if (low > most || !keeps(most)) return most + 1;
    high = most;
  }
  while (low < high) {
    const int middle = low + (high - low) / 2;
    if (keeps(middle)) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return high;
}

}  // namespace batten::internal
