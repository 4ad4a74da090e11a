// SPDX-License-Identifier: MIT
// The nearest of many points, and those in a ball, in double precision: a balanced tree of halved
// point sets.
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <vector>

namespace batten::internal {

class PointKdTree {
 public:
  PointKdTree() = default;
  // Points are columns. O(n log n).
  explicit PointKdTree(const Eigen::Matrix3Xd& points);

  // The index of the nearest point; the first of equals in the tree's order. Needs a point. With a
  // limit, −1 where no squared distance is below it.
  int Nearest(const double* q, double limit = std::numeric_limits<double>::infinity()) const;

  // Calls visit(index, squared distance) for every point within the radius, in the tree's order.
  template <typename Visit>
  void ForBall(const Eigen::Vector3d& centre, double radius, const Visit& visit) const;

 private:
  // A leaf holds the points of [begin, end) of the order; an inner node cuts at a plane.
  struct Node {
    int axis = -1;  // −1: a leaf
    double cut = 0;
    int below = 0, above = 0;  // children, or the leaf's begin and end
  };
  int Build(const Eigen::Matrix3Xd& points, int begin, int end);

  std::vector<Node> nodes_;
  std::vector<int> order_;
  std::vector<double> x_, y_, z_;  // in order
  Eigen::Vector3d low_, high_;     // of all points
};

template <typename Visit>
void PointKdTree::ForBall(const Eigen::Vector3d& centre, double radius, const Visit& visit) const {
  if (order_.empty()) return;
  const double most = radius * radius;
  std::array<int, 64> waiting;
  int count = 0;
  waiting[count++] = 0;
  while (count > 0) {
    const Node& node = nodes_[waiting[--count]];
    if (node.axis >= 0) {
      // In squares, as distances are: what rounding lets through there comes along here.
      const double off = centre[node.axis] - node.cut;
      const bool near = off * off <= most;
      if (near || off > 0) waiting[count++] = node.above;
      if (near || off < 0) waiting[count++] = node.below;
      continue;
    }
    for (int k = node.below; k < node.above; ++k) {
      const double dx = x_[k] - centre[0], dy = y_[k] - centre[1], dz = z_[k] - centre[2];
      const double squared = dx * dx + dy * dy + dz * dz;
      if (squared <= most) visit(order_[k], squared);
    }
  }
}

}  // namespace batten::internal
