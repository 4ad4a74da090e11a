// SPDX-License-Identifier: MIT
#include "fitting/corners/corner_screen.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "fitting/corners/corner_windows.h"

namespace batten::internal {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr double kFewestInScreenBlock = 24;
constexpr double kScreenLineAngle = 0.05;  // standard deviation of the direction from mean to mean
constexpr Index kFewestBlocks = 200;
constexpr Index kAcross = 3;           // blocks from a direction to the one it is compared with
constexpr double kShare = 0.5;         // of the least angle that a smooth curve may turn
constexpr double kWidestScreen = 3;    // of the variance that noise gives a straight block
constexpr double kScreenReach = 8;     // sides of windows, either way
constexpr double kSideSteps = 30;      // about, of the narrowest side; or kBroadWidths
constexpr double kMostScreened = 0.5;  // of the points: beyond, ranges do not pay

// The mean of a block and how far from it its points are, across the line from end to end.
struct Block {
  Vector3d mean = Vector3d::Zero();
  double across = 0;  // variance
};

Block BlockOf(const Eigen::Matrix3Xd& points, Index begin, Index size) {
  const auto part = points.middleCols(begin, size);
  Block block;
  block.mean = part.rowwise().mean();
  const Index half = size / 2;
  const Vector3d along =
      (part.rightCols(half).rowwise().mean() - part.leftCols(half).rowwise().mean()).normalized();
  double squares = 0, lengths = 0;
  for (Index k = 0; k < size; ++k) {
    const Vector3d off = part.col(k) - block.mean;
    const double ahead = off.dot(along);
    squares += off.squaredNorm();
    lengths += ahead * ahead;
  }
  block.across = (squares - lengths) / static_cast<double>(size);
  return block;
}

// Blocks that may hold a corner.
std::vector<bool> Suspects(const Eigen::Matrix3Xd& points,
                           Index blocks,
                           const CornerOptions& options) {
  const auto count = static_cast<size_t>(blocks);
  const double widest = kWidestScreen * 2 * options.noise * options.noise;
  std::vector<Vector3d> means(count);
  std::vector<bool> suspect(count);
  for (Index b = 0; b < blocks; ++b) {
    const Index begin = b * points.cols() / blocks, end = (b + 1) * points.cols() / blocks;
    const Block block = BlockOf(points, begin, end - begin);
    suspect[static_cast<size_t>(b)] = block.across > widest;
    means[static_cast<size_t>(b)] = block.mean;
  }
  const auto slot = [&](Index b) { return static_cast<size_t>(b % blocks); };
  const double least = std::cos(kShare * options.least_angle);
  const Index last = options.closed ? blocks : blocks - 1 - kAcross;
  for (Index b = 0; b < last; ++b) {
    const Vector3d before = means[slot(b + 1)] - means[slot(b)],
                   after = means[slot(b + kAcross + 1)] - means[slot(b + kAcross)];
    if (before.dot(after) >= least * std::sqrt(before.squaredNorm() * after.squaredNorm()))
      continue;
    for (Index i = b; i <= b + kAcross + 1; ++i) suspect[slot(i)] = true;
  }
  return suspect;
}

}  // namespace

std::vector<CornerRange> RangesWithCorners(const Eigen::Matrix3Xd& points,
                                           double step,
                                           const CornerOptions& options) {
  const Index m = points.cols();
  const std::vector<CornerRange> all{{0, m}};
  const double noise = options.noise / step;  // in steps; means of n have √2 σ / √n across n steps
  const double in_block =
      std::max(kFewestInScreenBlock, std::pow(2 * noise / kScreenLineAngle, 2.0 / 3.0));
  if (!(in_block * static_cast<double>(kFewestBlocks) <= static_cast<double>(m))) return all;
  const auto blocks = static_cast<Index>(static_cast<double>(m) / in_block);
  const std::vector<bool> suspect = Suspects(points, blocks, options);
  const auto reach = static_cast<Index>(kScreenReach * std::max(kSideSteps, kBroadWidths * noise));
  std::vector<CornerRange> ranges;
  for (Index b = 0; b < blocks; ++b) {
    if (!suspect[static_cast<size_t>(b)]) continue;
    Index low = b * m / blocks - reach, high = (b + 1) * m / blocks + reach;
    if (!options.closed) {
      low = std::max<Index>(low, 0);
      high = std::min(high, m);
    }
    if (!ranges.empty() && low <= ranges.back().begin + ranges.back().size)
      ranges.back().size = high - ranges.back().begin;
    else
      ranges.push_back({low, high - low});
  }
  if (ranges.size() > 1 && ranges.front().begin + m <= ranges.back().begin + ranges.back().size) {
    ranges.front().size += ranges.front().begin + m - ranges.back().begin;
    ranges.front().begin = ranges.back().begin - m;
    ranges.pop_back();
  }
  double sum = 0;
  for (const CornerRange& range : ranges) sum += static_cast<double>(range.size);
  return sum > kMostScreened * static_cast<double>(m) ? all : ranges;
}

}  // namespace batten::internal
