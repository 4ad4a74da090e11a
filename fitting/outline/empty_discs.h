// SPDX-License-Identifier: MIT
// Centres of empty discs of one radius among points, and the points near their rims.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// A grid of cells a quarter of the radius wide that marks possible centres of empty discs. It is
// conservative: every true centre is marked. Where the box of the points is mostly empty every
// place counts as a possible centre. O(m) and O(area / radius²).
class EmptyDiscs {
 public:
  EmptyDiscs(const Eigen::Matrix2Xd& points, double radius, ThreadPool& pool);

  // Whether a disc about this place may be empty.
  bool MayBeCentre(const Eigen::Vector2d& place) const;

  // The points, in their order, that may lie on the rim of an empty disc.
  const std::vector<int>& touched() const { return touched_; }

 private:
  std::int64_t CellOf(const Eigen::Vector2d& place) const;  // −1: outside the grid

  Eigen::Vector2d corner_;
  double side_;
  std::int64_t nu_ = 0, nv_ = 0;  // none: no grid
  std::vector<std::uint8_t> centres_;
  std::vector<int> touched_;
};

}  // namespace batten::internal
