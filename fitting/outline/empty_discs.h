// SPDX-License-Identifier: MIT
// Where discs of one radius may lie that hold no point, and the points next to them.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// A grid of cells a quarter of the radius wide. Errs on the safe side only: every centre of an
// empty disc is told. Where the box of the points is mostly empty everything may be the centre of
// one. O(m) and O(area / radius²).
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
