// SPDX-License-Identifier: MIT
// A tree of axis-aligned boxes, eight to a node, asked which boxes lie nearer than a distance.
#pragma once

#include <Eigen/Geometry>
#include <vector>

namespace batten::internal {

class BoundingVolumeTree {
 public:
  // Eight boxes and what they stand for: a node (≥ 0), or box k of the caller (−1 − k). Lanes that
  // stand for nothing hold an empty box.
  struct Node {
    double low[3][8], high[3][8];
    int child[8];
  };
  // A box found near, and the square of its distance.
  struct Near {
    int box;
    double squared_distance;
  };

  BoundingVolumeTree() = default;
  // Boxes are not empty. O(n log n).
  explicit BoundingVolumeTree(const std::vector<Eigen::AlignedBox3d>& boxes);

  // Appends every box whose squared distance to q is at most `squared`, in the order of the tree.
  void Within(const double* q, double squared, std::vector<Near>& found) const;

 private:
  std::vector<Node> nodes_;
};

}  // namespace batten::internal
