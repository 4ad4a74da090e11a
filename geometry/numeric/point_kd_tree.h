// SPDX-License-Identifier: MIT
// Nearest of many points, for starts: a balanced tree of halved point sets.
#pragma once

#include <Eigen/Core>
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

}  // namespace batten::internal
