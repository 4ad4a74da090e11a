// SPDX-License-Identifier: MIT
// Nearest neighbours among the points of a cloud.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "batten/geometry/thread_pool.h"

namespace batten {

// An exact tree of boxes over float copies of local coordinates (about 18 bytes a point); which
// points are neighbours is decided in float, every distance that matters is for the caller to take
// in double. Points are halved across the widest side of their box until 32 are left; eight boxes
// are compared at a time. [Friedman, Bentley & Finkel 1977]
class NeighbourIndex {
 public:
  // Points relative to an origin near them (3 × m). O(m log m); the same on any number of threads.
  // Throws std::invalid_argument where there are none.
  explicit NeighbourIndex(const Eigen::Matrix3Xd& points);
  NeighbourIndex(const Eigen::Matrix3Xd& points, ThreadPool& pool);
  ~NeighbourIndex();
  NeighbourIndex(NeighbourIndex&&) noexcept;
  NeighbourIndex& operator=(NeighbourIndex&&) noexcept;

  Eigen::Index size() const;

  // For each query (3 × q) the min(k, m) nearest points, nearest first: result[i·k + j]. A point of
  // the cloud is its own first neighbour, or a duplicate of it. Thread-safe. O(q log m), quicker
  // where one query is near the next.
  std::vector<int> Nearest(const Eigen::Matrix3Xd& queries, int k) const;

  // All points, those near each other close together: 32 · 2ⁿ from a multiple of 32 · 2ⁿ on are the
  // points of one box.
  std::span<const int> order() const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace batten
