// SPDX-License-Identifier: MIT
#include "fitting/outline/empty_discs.h"

#include <cmath>
#include <numeric>

#include "fitting/core/shared_constants.h"

namespace batten::internal {
namespace {

constexpr int kCells = 4;  // cells per radius

using Cells = std::vector<std::uint8_t>;

// What lies at most `reach` cells away along one direction, whose next cell is `step` further.
Cells Spread(const Cells& cells, std::int64_t step, int reach) {
  Cells result = cells;
  const auto count = static_cast<std::int64_t>(cells.size());
  for (int k = 1; k <= reach; ++k) {
    const std::int64_t shift = k * step;
    for (std::int64_t i = shift; i < count; ++i) result[i] |= cells[i - shift];
    for (std::int64_t i = shift; i < count; ++i) result[i - shift] |= cells[i];
  }
  return result;
}

}  // namespace

// A disc about any place of a cell covers wholly those cells (i, j) away for which
// (|i| + 1)² + (|j| + 1)² ≤ kCells²: with kCells = 4 rows of 3, 5, 5, 5 and 3.
EmptyDiscs::EmptyDiscs(const Eigen::Matrix2Xd& points, double radius, ThreadPool& pool)
    : corner_(Eigen::Vector2d::Zero()), side_(radius / kCells) {
  if (points.cols() == 0) return;
  const Eigen::Vector2d low = points.rowwise().minCoeff(), high = points.rowwise().maxCoeff();
  const int pad = kCells + 2;
  corner_ = low.array() - pad * side_;
  const Eigen::Array2d sides = ((high - low) / side_).array().floor() + 1 + 2 * pad;
  if (sides.prod() > 1e6 + 32.0 * static_cast<double>(points.cols())) {
    touched_.resize(static_cast<size_t>(points.cols()));
    std::iota(touched_.begin(), touched_.end(), 0);
    return;
  }
  nu_ = static_cast<std::int64_t>(sides[0]);
  nv_ = static_cast<std::int64_t>(sides[1]);
  std::vector<std::int64_t> cell(static_cast<size_t>(points.cols()));
  pool.For(points.cols(), kPointsPerTask, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) cell[k] = CellOf(points.col(k));
  });
  Cells occupied(static_cast<size_t>(nu_ * nv_), 0);
  for (const std::int64_t c : cell) occupied[c] = 1;
  const Cells near = Spread(occupied, 1, 1), far = Spread(occupied, 1, 2);
  centres_.assign(occupied.size(), 1);
  const auto inner = static_cast<std::int64_t>(centres_.size()) - 2 * nu_;
  for (std::int64_t c = 2 * nu_; c < inner; ++c)
    centres_[c] =
        1 ^ (far[c - nu_] | far[c] | far[c + nu_] | near[c - 2 * nu_] | near[c + 2 * nu_]);
  const Cells reached = Spread(Spread(centres_, 1, kCells + 1), nu_, kCells + 1);
  for (size_t k = 0; k < cell.size(); ++k)
    if (reached[cell[k]] != 0) touched_.push_back(static_cast<int>(k));
}

std::int64_t EmptyDiscs::CellOf(const Eigen::Vector2d& place) const {
  const Eigen::Array2d cell = ((place - corner_) / side_).array().floor();
  if (!(cell >= 0).all() || cell[0] >= static_cast<double>(nu_) ||
      cell[1] >= static_cast<double>(nv_))
    return -1;
  return static_cast<std::int64_t>(cell[1]) * nu_ + static_cast<std::int64_t>(cell[0]);
}

bool EmptyDiscs::MayBeCentre(const Eigen::Vector2d& place) const {
  const std::int64_t cell = CellOf(place);
  return cell < 0 || centres_[cell] != 0;
}

}  // namespace batten::internal
