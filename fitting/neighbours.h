// SPDX-License-Identifier: MIT
// Nearest neighbours among the points of a cloud, by FLANN.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

namespace batten {

// An exact kd-tree over float copies of local coordinates (24 bytes a point and less); which points
// are neighbours is decided in float, every distance that matters is for the caller to take in
// double.
class NeighbourIndex {
 public:
  // Points relative to an origin near them (3 × m).
  explicit NeighbourIndex(const Eigen::Matrix3Xd& points);
  ~NeighbourIndex();
  NeighbourIndex(NeighbourIndex&&) noexcept;

  Eigen::Index size() const;

  // For each query (3 × q) the min(k, m) nearest points, nearest first: result[i·k + j]. A point of
  // the cloud is its own first neighbour, or a duplicate of it. Thread-safe. O(q log m).
  std::vector<int> Nearest(const Eigen::Matrix3Xd& queries, int k) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace batten
