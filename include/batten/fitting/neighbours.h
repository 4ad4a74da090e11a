// SPDX-License-Identifier: MIT
// Nearest neighbours among the points of a cloud.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "batten/geometry/thread_pool.h"

namespace batten {

// A k-d tree with bounding boxes for exact nearest-neighbour search, over float copies of local
// coordinates (about 18 bytes a point). Neighbours are compared in float; callers that need exact
// distances compute them in double. Points are halved across the widest side of their box until 32
// are left; eight boxes are compared at a time. [Friedman, Bentley & Finkel 1977]
class NeighbourIndex {
 public:
  // Builds the tree of points (3 × m) given relative to an origin near them. O(m log m); the same
  // on any number of threads. Throws std::invalid_argument if there are no points.
  explicit NeighbourIndex(const Eigen::Matrix3Xd& points);
  NeighbourIndex(const Eigen::Matrix3Xd& points, ThreadPool& pool);
  ~NeighbourIndex();
  NeighbourIndex(NeighbourIndex&&) noexcept;
  NeighbourIndex& operator=(NeighbourIndex&&) noexcept;

  Eigen::Index size() const;

  // Returns the min(k, m) nearest points of each query (3 × q), nearest first: result[i·k + j]. The
  // first neighbour of a point of the cloud is the point itself or a duplicate. Thread-safe.
  // O(q log m), faster if consecutive queries are near each other.
  std::vector<int> Nearest(const Eigen::Matrix3Xd& queries, int k) const;

  // All points in spatial order: each block of 32 · 2ⁿ that starts at a multiple of 32 · 2ⁿ holds
  // the points of one box.
  std::span<const int> order() const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace batten
